/* The load chart of a crane along rows of postures, two at a time: what loadChart.ts calls.
 *
 * The same laws as src/seacrane/design/chart.py, which says where they come from; shared fixtures hold both equal.
 * `make load-chart` compiles this file to loadChart.wasm beside it.
 *
 * In a row only one joint of the plane, the running one, moves. A point beyond it is at one + u cos(q) + v sin(q), with
 * coefficients of the row; on a slide, at one + u q. So is the moment of a force on it about any joint: a posture costs no
 * trigonometry. All is SI; x points outboard from the slewing axis, z up from the foot. */
#include <stdint.h>
#include <wasm_simd128.h>

#define EXPORT(name) __attribute__((export_name(#name))) name
#define GRAVITY 9.81
/* Pairs of postures of a row at most; of the last pair, the second may lie beyond the row, which harms nothing. */
#define ROW 320
/* Share of the stroke below which the oil column is not taken shorter: ports and heads hold that much. */
#define STROKE_MARGIN 0.01
/* Of the load at sea, over its offlead. */
#define SIDELEAD 0.5
/* Least height of the tip above the sea in the lead of the load and the length of the rope [m]. */
#define LEAST_HANG 1.0

typedef double pair __attribute__((vector_size(16)));
typedef int64_t mask __attribute__((vector_size(16)));

static inline pair both(double value) { return (pair){value, value}; }
static inline pair least(pair a, pair b) { return wasm_f64x2_pmin(a, b); }
static inline pair most(pair a, pair b) { return wasm_f64x2_pmax(a, b); }
static inline pair root(pair a) { return wasm_f64x2_sqrt(a); }
static inline pair down(pair a) { return wasm_f64x2_floor(a); }
static inline pair where(mask is, pair a, pair b) { return (pair)((is & (mask)a) | (~is & (mask)b)); }

/* ------------------------------------------------------------- tables of the row */
/* Of the running joint: cosine and sine of its angle, or its travel and nothing. */
static pair U[ROW], V[ROW];
/* Place of the tip [m]; load [kg], and index of the limit that governs it. */
static pair RADIUS[ROW], HEIGHT[ROW], LOAD[ROW], GOVERNS[ROW];
/* The largest share that a newton on the hook takes of a limit [1/N]; lead of the load over its height; how far a newton
 * on the hook lets it down [m/N]. */
static pair TAKEN[ROW], LEAD[ROW], COMPLIANCE[ROW];

pair *EXPORT(u)(void) { return U; }
pair *EXPORT(v)(void) { return V; }
pair *EXPORT(radius)(void) { return RADIUS; }
pair *EXPORT(height)(void) { return HEIGHT; }
pair *EXPORT(load)(void) { return LOAD; }
pair *EXPORT(governs)(void) { return GOVERNS; }

/* A quantity along the row: one + u U + v V. */
struct along {
    double one, u, v;
};
struct point {
    struct along x, z;
};

static inline pair at(struct along of, int j) { return of.one + of.u * U[j] + of.v * V[j]; }
static struct along plus(struct along a, double times, struct along b) {
    return (struct along){a.one + times * b.one, a.u + times * b.u, a.v + times * b.v};
}
static struct point beside(struct point a, double times, struct point b) {
    return (struct point){plus(a.x, times, b.x), plus(a.z, times, b.z)};
}

/* ------------------------------------------------------------- the crane */
/* A link: its mass, that of all that it carries too, and where those masses are in sum [kg.m]. */
struct link {
    double mass, x, z, origin_x, origin_z;
    int joint;
    double carried;
    struct point moment;
};

/* A frame: origin, cosine and sine of the angle of its x above the horizontal; with the running joint at zero. */
struct pose {
    double x, z, c, s;
};

/* What bears moments about a joint, or about the slewing axis. */
struct bearing {
    /* from low to high [N.m], and which limits these are */
    pair low, high, low_by, high_by;
    /* the oil lets the joint yield by soft [rad/(N.m), m/N]; it pulls in `pulled` of the rope over the falls [m] */
    pair soft, pulled;
};

/* A joint; the last of the array is the slewing ring. A growing coordinate turns x towards z if the sign is positive. */
struct joint {
    int link, turns, bears;
    double sign, slide_x, slide_z;
    /* where it stands: travel, cosine and sine; whether it moved since the last row */
    double q, c, s;
    int moved;
    /* what bears it: for each pair of postures, or one for all of a row (step 0); whether that is to be computed anew */
    struct bearing *bearing;
    int step, stale;
};

/* A free length between two pins, a cylinder or a rope; a link before the first is the foot. */
struct span {
    int inner, outer;
    double inner_x, inner_z, outer_x, outer_z;
    /* for each pair of postures, or one for all of a row (step 0) */
    pair *length;
    int pairs, step;
};

struct ram {
    struct span span;
    int joint;
    double push, pull, bore, annulus, stroke, closed;
    pair *lever;
};

/* A length of rope between sheaves, and what each joint between its ends pulls in of it. */
struct rope {
    struct span span;
    pair **levers;
};

struct strength {
    int joint;
    double moment;
};

static struct {
    struct link *links;
    struct pose *poses;
    struct joint *joints;
    struct ram *rams;
    struct rope *ropes;
    struct strength *strengths;
    int link_count, joint_count, ram_count, rope_count, strength_count;
    double bulk_modulus;
    /* of the angle at which the deck falls, outboard or across the boom; of the foot over the sea and aside of the ship's
     * middle [m] */
    double sine, cosine, foot, aside;
    /* what the slewing gear bears across, a pair for all rows; none if its first limit is endless */
    struct bearing gear;
    /* the tip on the last link; how many falls; give of the rope below the tip and up to the drum [1/N] */
    double tip_x, tip_z, falls, hang_give, rope_give;
    /* share of rope and winch that a newton takes, and which of both */
    double hoisted, hoisted_by;
    /* newtons for a kilogram without dynamics; the mass of the hook */
    double steady, hook;
    /* moments of the load alone [kg.m] and which limits they are */
    double load_moment, load_by, heeling_moment, heeling_by;
    /* lead of the load [m] and (v_r / g)^2 [s2]; none in harbour */
    double offlead, impact;
    /* of the rows: the running joint, pairs in a row, whether none was computed yet, where their tables begin */
    int runs, pairs, fresh;
    char *tables;
} crane;

/* Cells, columns fastest, rows from below; at the end of the memory. */
static struct {
    int width, height;
    /* where the tip of a posture is in it */
    double left, low, per_cell;
    /* The best posture of each cell: its load in steps of 1 / per_kilogram times `indices`, and its index; negative out of
     * reach. After the last cell, one for what is out of the raster. */
    double *best, per_kilogram, most, indices;
    /* of each cell [kg]; not a number out of reach */
    float *load;
} cells;

/* ------------------------------------------------------------- its description */
extern char __heap_base;
static char *room;

static char *end(void) { return (char *)(__builtin_wasm_memory_size(0) << 16); }

/* Zeros; traps if there is no room. */
static void *take(int count, int size) {
    char *const at = room;
    room += (count * size + 15) & ~15;
    if (room > (cells.load ? (char *)cells.load : end())) __builtin_trap();
    for (char *p = at; p < room; p++) *p = 0;
    return at;
}
#define TAKE(count, type) ((type *)take(count, sizeof(type)))

/* A new crane with room for so many of each; there is one at a time. */
void EXPORT(describe)(int links, int joints, int rams, int ropes, int strengths) {
    room = &__heap_base;
    crane.links = TAKE(links, struct link);
    crane.poses = TAKE(links, struct pose);
    crane.joints = TAKE(joints + 1, struct joint);
    crane.rams = TAKE(rams, struct ram);
    crane.ropes = TAKE(ropes, struct rope);
    crane.strengths = TAKE(strengths, struct strength);
    crane.tables = room;
    crane.link_count = crane.joint_count = crane.ram_count = crane.rope_count = crane.strength_count = 0;
}

void EXPORT(link)(double mass, double x, double z, double origin_x, double origin_z) {
    struct link *const link = &crane.links[crane.link_count++];
    link->mass = mass;
    link->x = x;
    link->z = z;
    link->origin_x = origin_x;
    link->origin_z = origin_z;
    link->joint = -1;
}

void EXPORT(joint)(int link, int turns, double sign, double slide_x, double slide_z) {
    crane.links[link].joint = crane.joint_count;
    struct joint *const joint = &crane.joints[crane.joint_count++];
    joint->link = link;
    joint->turns = turns;
    joint->sign = sign;
    joint->slide_x = slide_x;
    joint->slide_z = slide_z;
}

static struct span between(int inner, double inner_x, double inner_z, int outer, double outer_x, double outer_z) {
    return (struct span){inner, outer, inner_x, inner_z, outer_x, outer_z, 0, 0, 0};
}

void EXPORT(ram)(int inner, double inner_x, double inner_z, int outer, double outer_x, double outer_z, int joint,
                 double push, double pull, double bore, double annulus, double stroke, double closed) {
    const struct span span = between(inner, inner_x, inner_z, outer, outer_x, outer_z);
    crane.rams[crane.ram_count++] = (struct ram){span, joint, push, pull, bore, annulus, stroke, closed, 0};
    crane.joints[joint].bears = 1;
}

void EXPORT(rope)(int inner, double inner_x, double inner_z, int outer, double outer_x, double outer_z) {
    crane.ropes[crane.rope_count++].span = between(inner, inner_x, inner_z, outer, outer_x, outer_z);
}

/* A moment that the structure bears about a joint, or the slewing ring after the last. */
void EXPORT(strength)(int joint, double moment) {
    crane.strengths[crane.strength_count++] = (struct strength){joint, moment};
    crane.joints[joint].bears = 1;
}

void EXPORT(gear)(double torque, double by) {
    crane.gear = (struct bearing){both(-torque), both(torque), both(by), both(by), both(0), both(0)};
}

void EXPORT(stand_on)(double sine, double cosine, double foot, double aside, double bulk_modulus) {
    crane.sine = sine;
    crane.cosine = cosine;
    crane.foot = foot;
    crane.aside = aside;
    crane.bulk_modulus = bulk_modulus;
}

/* `give` of a metre of rope [1/N]; `hoisted`: the weight with its dynamics that rope and winch bear [N]. */
void EXPORT(hoist)(double tip_x, double tip_z, double falls, double give, double hoisted, double by, double hook) {
    crane.tip_x = tip_x;
    crane.tip_z = tip_z;
    crane.falls = falls;
    crane.hang_give = give / falls;
    crane.rope_give = give / falls / falls;
    crane.hoisted = 1 / hoisted;
    crane.hoisted_by = by;
    crane.hook = hook;
}

void EXPORT(rate)(double factor, double load_moment, double load_by, double heeling_moment, double heeling_by) {
    crane.steady = GRAVITY * factor;
    crane.load_moment = load_moment / GRAVITY;
    crane.load_by = load_by;
    crane.heeling_moment = heeling_moment / GRAVITY;
    crane.heeling_by = heeling_by;
}

void EXPORT(sea)(double offlead, double impact) {
    crane.offlead = offlead;
    crane.impact = impact;
}

/* ------------------------------------------------------------- geometry of a row */
static const struct pose FOOT = {0, 0, 1, 0};

static void pose(void) {
    struct pose before = FOOT;
    for (int i = 0; i < crane.link_count; i++) {
        const struct link *const link = &crane.links[i];
        const struct joint still = {.c = 1}, *const joint = link->joint < 0 ? &still : &crane.joints[link->joint];
        const double dx = link->origin_x + joint->q * joint->slide_x, dz = link->origin_z + joint->q * joint->slide_z;
        before = (struct pose){
            before.x + dx * before.c - dz * before.s,
            before.z + dx * before.s + dz * before.c,
            before.c * joint->c - before.s * joint->s,
            before.s * joint->c + before.c * joint->s,
        };
        crane.poses[i] = before;
    }
}

/* A point of a link. */
static struct point point(int link, double x, double z) {
    const struct pose pose = link < 0 ? FOOT : crane.poses[link];
    const double px = pose.x + x * pose.c - z * pose.s, pz = pose.z + x * pose.s + z * pose.c;
    const struct joint running = crane.joints[crane.runs];
    const struct pose axis = crane.poses[running.link];
    if (link < running.link) return (struct point){{px, 0, 0}, {pz, 0, 0}};
    if (running.turns)
        return (struct point){{axis.x, px - axis.x, axis.z - pz}, {axis.z, pz - axis.z, px - axis.x}};
    return (struct point){
        {px, running.slide_x * axis.c - running.slide_z * axis.s, 0},
        {pz, running.slide_x * axis.s + running.slide_z * axis.c, 0},
    };
}

/* The component of a force along the slide of joint k, which turns with the running joint if that is before it. */
static struct along slid(int k, double fx, double fz) {
    const struct joint joint = crane.joints[k];
    const struct pose pose = crane.poses[joint.link];
    const double dx = joint.slide_x * pose.c - joint.slide_z * pose.s;
    const double dz = joint.slide_x * pose.s + joint.slide_z * pose.c;
    const double with = fx * dx + fz * dz, across = fz * dx - fx * dz;
    if (k > crane.runs && crane.joints[crane.runs].turns) return (struct along){0, with, across};
    return (struct along){with, 0, 0};
}

/* What a force (fx, fz) on each of `times` points with this sum does on joint k, by virtual work: its moment about a
 * revolute joint, or about the slewing axis in the foot; its component along a slide. */
static struct along work(int k, struct point sum, double fx, double fz, double times) {
    const struct along none = {0, 0, 0};
    if (k == crane.joint_count) return plus(plus(none, fz, sum.x), -fx, sum.z);
    const struct joint joint = crane.joints[k];
    if (!joint.turns) return slid(k, times * fx, times * fz);
    const struct point arm = beside(sum, -times, point(joint.link, 0, 0));
    return plus(plus(none, joint.sign * fz, arm.x), -joint.sign * fx, arm.z);
}

static struct point parted(const struct span *span) {
    return beside(point(span->outer, span->outer_x, span->outer_z), -1,
                  point(span->inner, span->inner_x, span->inner_z));
}

static int spans(const struct span *span, int k) {
    return k < crane.joint_count && span->inner < crane.joints[k].link && crane.joints[k].link <= span->outer;
}

/* Length of a span [m]. */
static void measure(struct span *span) {
    const struct point gap = parted(span);
    for (int j = 0; j < span->pairs; j++) {
        const pair dx = at(gap.x, j), dz = at(gap.z, j);
        span->length[j] = root(dx * dx + dz * dz);
    }
}

/* Its derivative by joint k [m/rad, or 1]. */
static void derive(const struct span *span, int k, pair *lever) {
    const struct point gap = parted(span), outer = point(span->outer, span->outer_x, span->outer_z);
    const struct along by_x = work(k, outer, 1, 0, 1), by_z = work(k, outer, 0, 1, 1);
    for (int j = 0; j < span->pairs; j++) {
        const pair moved = at(gap.x, j) * at(by_x, j) + at(gap.z, j) * at(by_z, j);
        lever[j] = where(span->length[j] > 0, moved / span->length[j], both(0));
    }
}

/* ------------------------------------------------------------- what a joint bears */
static inline void bind(struct bearing *bearing, pair low, pair high, pair by) {
    bearing->low_by = where(low > bearing->low, by, bearing->low_by);
    bearing->high_by = where(high < bearing->high, by, bearing->high_by);
    bearing->low = most(bearing->low, low);
    bearing->high = least(bearing->high, high);
}

static void bear_by_ram(const struct ram *ram, double by, struct bearing *bearing, int pairs) {
    const double margin = STROKE_MARGIN * ram->stroke;
    for (int j = 0, i = 0; j < pairs; j++, i += ram->span.step) {
        const pair arm = ram->lever[i], pushing = ram->push * arm, pulling = -ram->pull * arm;
        const mask none = arm == 0;
        /* without a lever it bears nothing, not even a joint without load */
        bind(&bearing[j], where(none, both(1), least(pushing, pulling)), where(none, both(-1), most(pushing, pulling)),
             both(by));
        const pair extension = least(most(ram->span.length[i] - ram->closed, both(margin)), both(ram->stroke - margin));
        const pair oil = crane.bulk_modulus * (ram->bore / extension + ram->annulus / (ram->stroke - extension));
        bearing[j].soft += where(none, both(0), 1 / (arm * arm * oil));
    }
}

/* What joint k bears, and pulls in of the rope. */
static void tabulate(int k) {
    const struct joint *const joint = &crane.joints[k];
    const int pairs = joint->step ? crane.pairs : 1;
    const pair endless = both(__builtin_inf());
    struct bearing *const bearing = joint->bearing;
    for (int j = 0; j < pairs; j++)
        bearing[j] = (struct bearing){-endless, endless, both(0), both(0), both(0), both(0)};
    for (int i = 0; i < crane.ram_count; i++)
        if (crane.rams[i].joint == k) bear_by_ram(&crane.rams[i], i, bearing, pairs);
    for (int i = 0; i < crane.strength_count; i++) {
        const pair moment = both(crane.strengths[i].moment), by = both(crane.ram_count + i);
        if (crane.strengths[i].joint == k)
            for (int j = 0; j < pairs; j++) bind(&bearing[j], -moment, moment, by);
    }
    for (int i = 0; i < crane.rope_count; i++) {
        const struct rope *const rope = &crane.ropes[i];
        if (!spans(&rope->span, k)) continue;
        for (int j = 0; j < pairs; j++) bearing[j].pulled += rope->levers[k][j * rope->span.step] / crane.falls;
    }
}

/* ------------------------------------------------------------- limits along a row */
/* A raster is not told which limit governs: each of these is compiled twice. */
#define TWICE static inline __attribute__((always_inline))

/* Keeps the larger share, and by which limit; the whole of a limit that the crane exceeds by itself. */
TWICE void keep(int j, pair share, mask exceeded, pair by, int tells) {
    const pair taken = most(share, (pair)(exceeded & (mask)both(__builtin_inf())));
    if (tells) GOVERNS[j] = where(taken > TAKEN[j], by, GOVERNS[j]);
    TAKEN[j] = most(TAKEN[j], taken);
}

/* In harbour: what a newton on the hook takes of what the joint bears beyond its own moment. */
TWICE void bear(const struct bearing *bearing, int step, struct along own, struct along load, int tells) {
    for (int j = 0; j < crane.pairs; j++, bearing += step) {
        const pair self = at(own, j), plumb = at(load, j) + bearing->pulled;
        const mask lifted = plumb < 0;
        const pair share = plumb / (where(lifted, bearing->low, bearing->high) - self);
        keep(j, share, (self > bearing->high) | (self < bearing->low),
             where(lifted, bearing->low_by, bearing->high_by), tells);
    }
}

/* At sea the same for the load hanging plumb and led outboard; and what the oil gives. */
TWICE void sway(const struct bearing *bearing, int step, struct along own, struct along load, struct along led,
                int tells) {
    for (int j = 0; j < crane.pairs; j++, bearing += step) {
        const pair self = at(own, j), plumb = at(load, j) + bearing->pulled;
        const pair outboard = plumb + LEAD[j] * at(led, j);
        const pair high = most(plumb, outboard) / (bearing->high - self);
        const pair low = least(plumb, outboard) / (bearing->low - self);
        COMPLIANCE[j] += plumb * plumb * bearing->soft;
        keep(j, most(high, low), (self > bearing->high) | (self < bearing->low),
             where(low > high, bearing->low_by, bearing->high_by), tells);
    }
}

/* At sea: lead of the load, and how the rope gives. */
static void hang(void) {
    for (int j = 0; j < crane.pairs; j++) {
        const pair hang = most(HEIGHT[j] + crane.foot, both(LEAST_HANG));
        LEAD[j] = crane.offlead / hang;
        COMPLIANCE[j] = crane.hang_give * hang;
    }
    for (int i = 0; i < crane.rope_count; i++) {
        const struct span span = crane.ropes[i].span;
        for (int j = 0; j < crane.pairs; j++) COMPLIANCE[j] += crane.rope_give * span.length[j * span.step];
    }
}

/* In harbour: the mass whose weight takes the limit. */
static void still(void) {
    for (int j = 0; j < crane.pairs; j++) LOAD[j] = 1 / (crane.steady * TAKEN[j]);
}

/* At sea at most the mass m with psi m = what is borne, psi = 1 + sqrt(b / m), b = impact / compliance. */
static void meet(void) {
    for (int j = 0; j < crane.pairs; j++) {
        const pair weight = 1 / TAKEN[j], borne = weight * (1 / GRAVITY), b = crane.impact / COMPLIANCE[j];
        LOAD[j] = least(weight * (1 / crane.steady), 0.5 * (b + 2 * borne - root(b * (b + 4 * borne))));
    }
}

/* A limit to the moment of the load alone [kg.m], about an axis this far behind the slewing axis [m]. */
TWICE void within(double moment, double aside, double by, int tells) {
    for (int j = 0; j < crane.pairs; j++) {
        const pair mass = moment / (most(RADIUS[j], both(1e-9)) + aside);
        if (tells) GOVERNS[j] = where(mass < LOAD[j], both(by), GOVERNS[j]);
        LOAD[j] = least(LOAD[j], mass);
    }
}

/* ------------------------------------------------------------- rows */
static void lay_out(struct span *span) {
    span->step = spans(span, crane.runs);
    span->pairs = span->step ? crane.pairs : 1;
    span->length = TAKE(span->pairs, pair);
}

/* Rows in which joint `runs` takes the coordinates in the tables u and v, so many pairs of them; the others stand at
 * zero. */
void EXPORT(rows)(int runs, int pairs) {
    room = crane.tables;
    crane.runs = runs;
    crane.pairs = pairs;
    crane.fresh = 1;
    for (int k = 0; k <= crane.joint_count; k++) {
        struct joint *const joint = &crane.joints[k];
        joint->q = joint->s = joint->step = 0;
        joint->c = joint->stale = 1;
    }
    for (int i = 0; i < crane.ram_count; i++) {
        struct ram *const ram = &crane.rams[i];
        lay_out(&ram->span);
        ram->lever = TAKE(ram->span.pairs, pair);
        if (spans(&ram->span, ram->joint)) crane.joints[ram->joint].step |= ram->span.step;
    }
    for (int i = 0; i < crane.rope_count; i++) {
        struct rope *const rope = &crane.ropes[i];
        lay_out(&rope->span);
        rope->levers = TAKE(crane.joint_count, pair *);
        for (int k = 0; k < crane.joint_count; k++) {
            if (!spans(&rope->span, k)) continue;
            rope->levers[k] = TAKE(rope->span.pairs, pair);
            crane.joints[k].step |= rope->span.step;
        }
    }
    for (int k = 0; k <= crane.joint_count; k++) {
        struct joint *const joint = &crane.joints[k];
        joint->bearing = TAKE(joint->step ? pairs : 1, struct bearing);
    }
}

/* Put joint k, which does not run, to a coordinate: its travel, or cosine and sine of its angle. */
void EXPORT(stand)(int k, double q, double c, double s) {
    struct joint *const joint = &crane.joints[k];
    joint->q = q;
    joint->c = c;
    joint->s = s;
    joint->moved = 1;
}

/* Whether a span has another length than in the row before. */
static int moved(const struct span *span) {
    int moved = crane.fresh;
    for (int k = 0; k < crane.joint_count; k++) moved |= crane.joints[k].moved && spans(span, k);
    return moved;
}

/* Lengths and levers of what moved, and what the joints bear by it. */
static void settle(void) {
    for (int i = 0; i < crane.rope_count; i++) {
        struct rope *const rope = &crane.ropes[i];
        if (!moved(&rope->span)) continue;
        measure(&rope->span);
        for (int k = 0; k < crane.joint_count; k++) {
            if (!spans(&rope->span, k)) continue;
            derive(&rope->span, k, rope->levers[k]);
            crane.joints[k].stale = 1;
        }
    }
    for (int i = 0; i < crane.ram_count; i++) {
        struct ram *const ram = &crane.rams[i];
        if (!moved(&ram->span)) continue;
        measure(&ram->span);
        if (spans(&ram->span, ram->joint)) derive(&ram->span, ram->joint, ram->lever);
        crane.joints[ram->joint].stale = 1;
    }
    for (int k = 0; k <= crane.joint_count; k++) {
        if (crane.joints[k].stale && crane.joints[k].bears) tabulate(k);
        crane.joints[k].moved = crane.joints[k].stale = 0;
    }
    crane.fresh = 0;
}

/* Of each link with all that it carries: the mass, and where it is. */
static void sum(void) {
    struct point moment = {{0, 0, 0}, {0, 0, 0}};
    double mass = 0;
    for (int i = crane.link_count - 1; i >= 0; i--) {
        struct link *const link = &crane.links[i];
        link->carried = mass += link->mass;
        link->moment = moment = beside(moment, link->mass, point(i, link->x, link->z));
    }
}

/* What the load takes of the slewing gear where the deck falls across the boom, the load leading to either side. */
TWICE void turn(struct along radius, int tells) {
    const struct along none = {0, 0, 0}, own = plus(none, GRAVITY * crane.sine, crane.links[0].moment.x);
    const struct along plumb = plus(none, crane.sine, radius), side = plus(none, SIDELEAD * crane.cosine, radius);
    if (crane.impact > 0) {
        sway(&crane.gear, 0, own, plumb, side, tells);
        sway(&crane.gear, 0, own, plumb, plus(none, -1, side), tells);
    } else bear(&crane.gear, 0, own, plumb, tells);
}

/* Where the tips of the row are, and what they lift. */
TWICE void lift(int tells) {
    /* upward, with the deck falling outboard */
    const double x = -crane.sine, z = crane.cosine;
    const struct point tip = point(crane.link_count - 1, crane.tip_x, crane.tip_z);
    for (int j = 0; j < crane.pairs; j++) {
        RADIUS[j] = at(tip.x, j);
        HEIGHT[j] = at(tip.z, j);
        TAKEN[j] = both(crane.hoisted);
        if (tells) GOVERNS[j] = both(crane.hoisted_by);
    }
    if (crane.impact > 0) hang();
    for (int k = 0; k <= crane.joint_count; k++) {
        const struct joint *const joint = &crane.joints[k];
        if (!joint->bears) continue;
        const struct link *const link = &crane.links[k < crane.joint_count ? joint->link : 0];
        const struct along own = work(k, link->moment, GRAVITY * x, GRAVITY * z, link->carried);
        const struct along plumb = work(k, tip, x, z, 1);
        if (crane.impact > 0) sway(joint->bearing, joint->step, own, plumb, work(k, tip, -z, x, 1), tells);
        else bear(joint->bearing, joint->step, own, plumb, tells);
    }
    if (crane.gear.high[0] < __builtin_inf()) turn(tip.x, tells);
    if (crane.impact > 0) meet();
    else still();
    if (crane.load_moment < __builtin_inf()) within(crane.load_moment, 0, crane.load_by, tells);
    if (crane.heeling_moment < __builtin_inf()) within(crane.heeling_moment, crane.aside, crane.heeling_by, tells);
    for (int j = 0; j < crane.pairs; j++) LOAD[j] = most(LOAD[j] - crane.hook, both(0));
}

/* The loads of the row in which the joints stand now, and, if wanted, what governs them. */
void EXPORT(row)(int tells) {
    pose();
    settle();
    sum();
    if (tells) lift(1);
    else lift(0);
}

/* ------------------------------------------------------------- a raster of the section */
double *EXPORT(raster)(int width, int height, double left, double low, double per_cell, double per_kilogram, double most,
                       double indices) {
    cells.width = width;
    cells.height = height;
    cells.left = left;
    cells.low = low;
    cells.per_cell = per_cell;
    cells.per_kilogram = per_kilogram;
    cells.most = most;
    cells.indices = indices;
    cells.best = (double *)end() - (width * height + 1);
    cells.load = (float *)cells.best - width * height;
    return cells.best;
}

/* Brings the loads of the row to the cells of their tips; the postures have the indices `first`, `first` + `stride` and so
 * on. */
void EXPORT(bring)(int count, double first, double stride) {
    const int width = cells.width, height = cells.height;
    double *const best = cells.best;
    pair index = {first, first + stride};
    for (int j = 0; j < crane.pairs; j++, index += 2 * stride) {
        const pair column = RADIUS[j] * cells.per_cell + cells.left, line = HEIGHT[j] * cells.per_cell + cells.low;
        mask inside = (column >= 0) & (column < width) & (line >= 0) & (line < height);
        if (2 * j + 1 == count) inside[1] = 0;
        const pair cell = where(inside, down(line) * width + down(column), both((double)width * height));
        const v128_t to = wasm_i32x4_trunc_sat_f64x2_zero(cell);
        const pair value = down(least(LOAD[j] * cells.per_kilogram, both(cells.most))) * cells.indices + index;
        double *const a = &best[wasm_i32x4_extract_lane(to, 0)], *const b = &best[wasm_i32x4_extract_lane(to, 1)];
        /* one after the other, as both may be the same cell; without a branch, as it would go either way */
        wasm_v128_store64_lane(a, most(wasm_v128_load64_splat(a), value), 0);
        wasm_v128_store64_lane(b, most(wasm_v128_load64_splat(b), value), 1);
    }
}

/* The better of two postures beside a cell; none unless both are there. */
static inline double beside_both(double a, double b) { return a < 0 || b < 0 ? -1 : a > b ? a : b; }

/* Loads of the cells; one that no posture met, between two others, is like the better one. */
float *EXPORT(loads)(void) {
    const int width = cells.width, height = cells.height;
    const double *best = cells.best;
    float *load = cells.load;
    for (int row = 0; row < height; row++)
        for (int column = 0; column < width; column++, best++, load++) {
            double value = *best;
            if (value < 0 && row > 0 && row < height - 1 && column > 0 && column < width - 1) {
                value = beside_both(best[-1], best[1]);
                if (value < 0) value = beside_both(best[-width], best[width]);
            }
            *load = value < 0 ? __builtin_nanf("") : (float)(__builtin_floor(value / cells.indices) / cells.per_kilogram);
        }
    return cells.load;
}
