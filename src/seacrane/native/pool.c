/* Threads for slaves that may step side by side. Whether they pay is measured while the run goes on, and changes no
 * result: no slave of a group touches anything of another. Slaves in Python stay on the calling thread. */
#include "master.h"

static void step_one(plan_t *p, slave_t *s, int64_t from, int64_t size) {
    s->fault_stage = -1;
    (void)step_slave(p, s, from, size);
}

static void step_serially(plan_t *p, const group_t *g, int64_t from, int64_t size) {
    for (int64_t i = 0; i < g->count; ++i) {
        slave_t *s = p->slaves + g->members[i];
        if (!active(p, s)) continue;
        step_one(p, s, from, size);
        if (s->fault_stage >= 0) return; /* the sweep finds it before it looks at those that have not stepped */
    }
}

#if defined(_WIN32)
int64_t group_begin(plan_t *p, group_t *g) { (void)p, (void)g; return 0; }
void step_group(plan_t *p, group_t *g, int64_t from, int64_t size) { step_serially(p, g, from, size); }
void group_end(plan_t *p, group_t *g, int64_t begin) { (void)p, (void)g, (void)begin; }
void pool_end(plan_t *p) { (void)p; }
#else

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <time.h>

#define SPIN 2000           /* looks at the next work before a thread lies down: some 50 us */
#define WORTH_TRYING 10000  /* [ns] of a sweep, below which waking another thread cannot pay */
#define BLOCK 2             /* sweeps of one kind in a row, or more, for at least ... */
#define BLOCK_NS 200000     /* [ns]; the fastest counts, with threads awake, or with threads that have lain down again */
#define GAIN 0.9            /* the share of the time below which threads are taken */
#define HOLD 0.97           /* and that above which they are given up again */
#define PERIOD 2048         /* sweeps after which it is measured anew */
#define PATIENCE 10         /* what threads may lose before they are given up, in serial sweeps */
#define CREDIT 64           /* what of their gains is held against later losses */
#define DISTURBED 4         /* serial sweeps, beyond which it is not the threads that make a thread slow */
#define RARITY 50           /* how much longer than what was lost it is until the next trial */
#define LEAST_REST 256      /* sweeps */
#define MOST_REST 5e8       /* [ns]: whatever has disturbed a trial, it does not decide for longer */

enum { TRIAL, SETTLED };

struct pool {
    pthread_t *threads;
    int64_t count;
    pthread_mutex_t mutex;
    pthread_cond_t wake;
    plan_t *plan;
    const group_t *group;
    int64_t from, size;
    atomic_ullong open;/* members nobody has taken yet; above them a number of the sweep, lest two of them be confused */
    atomic_long left;  /* members that are not done */
    atomic_int sleeping, over;
};

#define SWEEP (1ull << 32)

static void pause_briefly(void) {
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#endif
}

static int64_t open_members(pool_t *pool) { return (int64_t)(atomic_load(&pool->open) % SWEEP); }

/* Step members as long as there are any: several at once while there are many, so that threads do not wait for each
 * other's taking. A sweep is over only when all that were taken are done: until then, what the pool says of it holds, for
 * a thread that comes late as well. */
static void take_members(pool_t *pool) {
    for (unsigned long long open = atomic_load(&pool->open); open % SWEEP > 0;) {
        const int64_t rest = (int64_t)(open % SWEEP), taken = 1 + rest / (4 * (pool->count + 1));
        if (!atomic_compare_exchange_weak(&pool->open, &open, open - (unsigned long long)taken)) continue;
        const group_t *g = pool->group;
        for (int64_t i = g->count - rest; i < g->count - rest + taken; ++i) {
            slave_t *s = pool->plan->slaves + g->members[i];
            if (!s->callback && active(pool->plan, s)) step_one(pool->plan, s, pool->from, pool->size);
        }
        atomic_fetch_sub(&pool->left, (long)taken);
        open = atomic_load(&pool->open);
    }
}

static void *work(void *argument) {
    pool_t *pool = argument;
    for (;;) {
        for (int i = 0; i < SPIN && !open_members(pool) && !atomic_load(&pool->over); ++i) pause_briefly();
        if (!open_members(pool)) {
            pthread_mutex_lock(&pool->mutex);
            atomic_fetch_add(&pool->sleeping, 1);
            while (!open_members(pool) && !atomic_load(&pool->over)) pthread_cond_wait(&pool->wake, &pool->mutex);
            atomic_fetch_sub(&pool->sleeping, 1);
            pthread_mutex_unlock(&pool->mutex);
        }
        if (atomic_load(&pool->over)) return NULL;
        take_members(pool);
    }
}

/* As many threads as the system gives, beside the calling one; no pool if it gives none. */
static pool_t *pool_begin(plan_t *plan, int64_t threads) {
    pool_t *pool = calloc(1, sizeof *pool);
    if (!pool || !(pool->threads = calloc((size_t)threads, sizeof *pool->threads))) {
        free(pool);
        return NULL;
    }
    pool->plan = plan;
    pthread_mutex_init(&pool->mutex, NULL);
    pthread_cond_init(&pool->wake, NULL);
    while (pool->count < threads && pthread_create(pool->threads + pool->count, NULL, work, pool) == 0) ++pool->count;
    return pool;
}

void pool_end(plan_t *p) {
    pool_t *pool = p->pool;
    if (!pool) return;
    atomic_store(&pool->over, 1);
    pthread_mutex_lock(&pool->mutex);
    pthread_cond_broadcast(&pool->wake);
    pthread_mutex_unlock(&pool->mutex);
    for (int64_t i = 0; i < pool->count; ++i) pthread_join(pool->threads[i], NULL);
    pthread_cond_destroy(&pool->wake);
    pthread_mutex_destroy(&pool->mutex);
    free(pool->threads);
    free(pool);
    p->pool = NULL;
}

static int64_t now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
}

static void step_in_parallel(plan_t *p, group_t *g, int64_t from, int64_t size) {
    pool_t *pool = p->pool;
    pool->group = g, pool->from = from, pool->size = size;
    atomic_store(&pool->left, g->count);
    atomic_store(&pool->open, (atomic_load(&pool->open) / SWEEP + 1) * SWEEP + (unsigned long long)g->count);
    if (atomic_load(&pool->sleeping)) {
        pthread_mutex_lock(&pool->mutex);
        pthread_cond_broadcast(&pool->wake);
        pthread_mutex_unlock(&pool->mutex);
    }
    for (int64_t i = 0; i < g->count; ++i) {
        slave_t *s = p->slaves + g->members[i];
        if (s->callback && active(p, s)) step_one(p, s, from, size);
    }
    take_members(pool);
    const int64_t done = now();
    for (int i = 0; atomic_load(&pool->left); ++i) {
        if (i < SPIN) pause_briefly();
        else sched_yield();
    }
    g->waited_ns = now() - done;
}

static int64_t median(int64_t *v) {
    for (int i = 1; i < TRIALS; ++i)
        for (int j = i; j > 0 && v[j - 1] > v[j]; --j) {
            const int64_t kept = v[j];
            v[j] = v[j - 1];
            v[j - 1] = kept;
        }
    return v[TRIALS / 2];
}

/* Threads or none from now on, until the next trial. What they have lost is a small share of the time until then. */
static void settle(group_t *g, int parallel) {
    g->phase = SETTLED;
    g->parallel = parallel;
    g->left = PERIOD;
    if (parallel || g->serial_ns <= WORTH_TRYING) return;
    double rest = RARITY * (double)g->lost_ns;
    if (rest > MOST_REST) rest = MOST_REST;
    rest /= (double)g->serial_ns;
    g->left = rest > LEAST_REST ? (int64_t)rest : LEAST_REST;
    g->lost_ns = 0;
}

/* The time of a sweep over the group, and what follows from it. A trial is of blocks of both kinds in turn, so that
 * whatever else the machine does slows both; the medians count, so that a few disturbed blocks do not. */
static void judge(plan_t *p, group_t *g, int64_t time) {
    if (g->threaded) {
        g->lost_ns += time - g->serial_ns;
        if (g->lost_ns < -CREDIT * g->serial_ns) g->lost_ns = -CREDIT * g->serial_ns;
        if (g->lost_ns > PATIENCE * g->serial_ns) settle(g, 0);
    }
    if (g->phase == SETTLED) return;
    int64_t *least = g->trial_ns[g->threaded] + g->block / 2;
    if (g->taken == 0 || time < *least) *least = time;
    g->taken += 1;
    g->block_ns += time;
    if (g->taken < BLOCK || g->block_ns < BLOCK_NS) return;
    g->taken = g->block_ns = 0;
    if (!g->threaded && (g->block == 0 || *least < g->serial_ns)) g->serial_ns = *least;
    g->block += 1;
    if (g->block == 1) {
        if (g->serial_ns > WORTH_TRYING && !p->pool)
            p->pool = pool_begin(p, (p->threads < g->natives ? p->threads : g->natives) - 1);
        if (g->serial_ns <= WORTH_TRYING || !p->pool || p->pool->count == 0) settle(g, 0);
    } else if (g->block == 2 * TRIALS) {
        g->serial_ns = median(g->trial_ns[0]);
        settle(g, (double)median(g->trial_ns[1]) < (g->parallel ? HOLD : GAIN) * (double)g->serial_ns);
    }
}

/* Whether the group is stepped by threads this time; when it begins, 0 where that is not measured. */
int64_t group_begin(plan_t *p, group_t *g) {
    g->threaded = 0;
    if (p->threads < 2 || g->natives < 2) return 0;
    if (g->phase == SETTLED && --g->left <= 0) {
        g->phase = TRIAL;
        g->block = g->taken = g->block_ns = 0;
    }
    if (g->phase == SETTLED && !g->parallel) return 0;
    g->threaded = g->phase == SETTLED || g->block % 2;
    g->waited_ns = 0;
    return now();
}

/* Step the members of a group; faults are left in the slaves. */
void step_group(plan_t *p, group_t *g, int64_t from, int64_t size) {
    if (g->threaded) step_in_parallel(p, g, from, size);
    else step_serially(p, g, from, size);
}

/* Where this thread's own work took far longer than all of it should, that is mostly a disturbance that would have
 * struck without threads as well. */
void group_end(plan_t *p, group_t *g, int64_t begin) {
    if (begin == 0) return;
    const int64_t own = now() - begin - g->waited_ns, most = DISTURBED * g->serial_ns;
    judge(p, g, (g->threaded && own > most ? most : own) + g->waited_ns);
}
#endif
