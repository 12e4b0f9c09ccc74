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
void step_group(plan_t *p, group_t *g, int64_t from, int64_t size) { step_serially(p, g, from, size); }
void pool_end(plan_t *p) { (void)p; }
#else

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <time.h>

#define SPIN 2000           /* looks at the next work before a thread lies down: some 50 us */
#define PERIOD 4096         /* sweeps after which threads that paid, or cannot pay, are measured anew */
#define WORTH_TRYING 10000  /* [ns] of a sweep, below which waking another thread cannot pay */
#define GAIN 0.9            /* threads must take less than this share of the time */
#define PATIENCE 10         /* sweeps that a trial of threads may cost */
#define RARITY 50           /* how much longer than a trial that has failed it takes until the next */
#define WINDOW 16           /* sweeps after which threads must still have paid */

enum { TRY_SERIAL, TRY_PARALLEL, SETTLED };

struct pool {
    pthread_t *threads;
    int64_t count;
    pthread_mutex_t mutex;
    pthread_cond_t wake;
    plan_t *plan;
    const group_t *group;
    int64_t from, size;
    atomic_long round;      /* counts the work given out */
    atomic_long next, left; /* members to take, and threads that have not finished */
    atomic_int sleeping, over;
};

static void pause_briefly(void) {
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#endif
}

static void take_members(pool_t *pool) {
    plan_t *p = pool->plan;
    const group_t *g = pool->group;
    for (long i; (i = atomic_fetch_add(&pool->next, 1)) < g->count;) {
        slave_t *s = p->slaves + g->members[i];
        if (!s->callback && active(p, s)) step_one(p, s, pool->from, pool->size);
    }
}

static void *work(void *argument) {
    pool_t *pool = argument;
    for (long seen = 0;;) {
        for (int i = 0; i < SPIN && atomic_load(&pool->round) == seen && !atomic_load(&pool->over); ++i) pause_briefly();
        if (atomic_load(&pool->round) == seen) {
            pthread_mutex_lock(&pool->mutex);
            atomic_fetch_add(&pool->sleeping, 1);
            while (atomic_load(&pool->round) == seen && !atomic_load(&pool->over))
                pthread_cond_wait(&pool->wake, &pool->mutex);
            atomic_fetch_sub(&pool->sleeping, 1);
            pthread_mutex_unlock(&pool->mutex);
        }
        if (atomic_load(&pool->over)) return NULL;
        seen = atomic_load(&pool->round);
        take_members(pool);
        atomic_fetch_sub(&pool->left, 1);
    }
}

/* As many threads as the system gives, beside the calling one; no pool if it gives none. */
static pool_t *pool_begin(int64_t threads) {
    pool_t *pool = calloc(1, sizeof *pool);
    if (!pool || !(pool->threads = calloc((size_t)threads, sizeof *pool->threads))) {
        free(pool);
        return NULL;
    }
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

static void step_in_parallel(plan_t *p, const group_t *g, int64_t from, int64_t size) {
    pool_t *pool = p->pool;
    pool->plan = p, pool->group = g, pool->from = from, pool->size = size;
    atomic_store(&pool->next, 0);
    atomic_store(&pool->left, pool->count);
    atomic_fetch_add(&pool->round, 1);
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
    for (int i = 0; atomic_load(&pool->left); ++i) {
        if (i < SPIN) pause_briefly();
        else sched_yield();
    }
}

static int64_t now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
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

static void settle(group_t *g, int parallel) {
    const int64_t rest = g->serial_ns > 0 ? RARITY * g->spent_ns / g->serial_ns : 0;
    g->phase = SETTLED;
    g->parallel = parallel;
    g->left = !parallel && rest > 0 ? rest : PERIOD;
    g->taken = g->spent_ns = 0;
}

/* The time of a sweep, serial or parallel, and what follows from it. */
static void judge(plan_t *p, group_t *g, int64_t time) {
    g->spent_ns += time;
    if (g->phase == SETTLED) { /* in parallel */
        if (++g->taken < WINDOW) return;
        if (g->spent_ns > WINDOW * g->serial_ns) settle(g, 0);
        g->taken = g->spent_ns = 0;
        return;
    }
    g->trial_ns[g->taken++] = time;
    if (g->phase == TRY_SERIAL) {
        if (g->taken < TRIALS) return;
        g->serial_ns = median(g->trial_ns);
        g->taken = g->spent_ns = 0;
        if (g->serial_ns > WORTH_TRYING && !p->pool)
            p->pool = pool_begin((p->threads < g->natives ? p->threads : g->natives) - 1);
        if (g->serial_ns > WORTH_TRYING && p->pool && p->pool->count > 0) g->phase = TRY_PARALLEL;
        else settle(g, 0);
    } else if (g->spent_ns > PATIENCE * g->serial_ns) {
        settle(g, 0);
    } else if (g->taken == TRIALS) {
        settle(g, (double)median(g->trial_ns) < GAIN * (double)g->serial_ns);
    }
}

/* Step the members of a group; faults are left in the slaves. */
void step_group(plan_t *p, group_t *g, int64_t from, int64_t size) {
    if (p->threads < 2 || g->natives < 2) {
        step_serially(p, g, from, size);
        return;
    }
    if (g->phase == SETTLED && --g->left <= 0) g->phase = TRY_SERIAL, g->taken = g->spent_ns = 0;
    if (g->phase == SETTLED && !g->parallel) {
        step_serially(p, g, from, size);
        return;
    }
    const int64_t begin = now();
    (g->phase == TRY_SERIAL ? step_serially : step_in_parallel)(p, g, from, size);
    judge(p, g, now() - begin);
}
#endif
