/* Calls of the generated equations, and results that are computed only when somebody asks for them. */
#include "core.h"

#include <string.h>

/* The inputs at time t, along their ramps if they have any. */
const double *inputs_at(struct instance *m, double t)
{
    const struct state *s = &m->state;
    double h = t - s->time;
    if (s->sloped != RAMPED || h == 0)
        return s->u;
    for (int i = 0; i < NU; i++)
        m->work.u[i] = s->u[i] + h * (s->slope[i] + h / 2 * s->curvature[i]);
    return m->work.u;
}

/* Moves the time to t, taking the inputs along. */
void move_to(struct instance *m, double t)
{
    struct state *s = &m->state;
    double h = t - s->time;
    if (s->sloped == RAMPED)
        for (int i = 0; i < NU; i++) {
            s->u[i] += h * (s->slope[i] + h / 2 * s->curvature[i]);
            s->slope[i] += h * s->curvature[i];
        }
    s->time = t;
}

static void call(struct instance *m, model_function *function, const double *t, const double *y, const double *u)
{
    struct workspace *w = &m->work;
    w->argument[0] = t;
    w->argument[1] = y;
    w->argument[2] = u;
    w->argument[3] = m->state.p;
    function(w->argument, w->result, w->iw, w->w, 0);
}

void evaluate_residual(struct instance *m, double t, const double *y, double *f)
{
    m->work.result[0] = f;
    call(m, model_residual, &t, y, inputs_at(m, t));
    m->statistics.residuals++;
}

/* Leaves f, the nonzeros of df/dy and the total time derivative of f along the inputs' slopes in the workspace. */
void evaluate_jacobian(struct instance *m, double t, const double *y)
{
    struct workspace *w = &m->work;
    const double *u = inputs_at(m, t);
    w->result[0] = w->f;
    w->result[1] = w->nonzeros;
    w->result[2] = w->ft;
    call(m, model_jacobian, &t, y, u);
    if (m->state.sloped == RAMPED) {
        w->argument[4] = m->state.slope;
        w->result[0] = w->rate;
        call(m, model_input_rate, &t, y, u);
        for (int i = 0; i < N; i++)
            w->ft[i] += w->rate[i];
    }
    m->statistics.jacobians++;
}

/* The algebraic residual and, if `matrix` is given, dalg/dz (dense, row-major). */
void evaluate_algebraic(struct instance *m, double t, const double *y, double *alg, double *matrix)
{
    struct workspace *w = &m->work;
    w->result[0] = alg;
    w->result[1] = matrix != NULL ? w->nonzeros_alg : NULL;
    call(m, model_algebraic, &t, y, inputs_at(m, t));
    if (matrix != NULL) {
        memset(matrix, 0, NZ * NZ * sizeof(double));
        for (int k = 0; k < NNZ_ALG; k++)
            matrix[model_row_alg[k] * NZ + model_column_alg[k]] = w->nonzeros_alg[k];
    }
}

/* One for each event. */
void evaluate_indicators(struct instance *m, double t, const double *y, double *indicator)
{
    m->work.result[0] = indicator;
    call(m, model_indicate, &t, y, inputs_at(m, t));
}

/* States, then modes, after the events that are `due` (not zero) at the present point. */
void evaluate_reset(struct instance *m, const double *due, double *after)
{
    m->work.argument[4] = due;
    m->work.result[0] = after;
    call(m, model_reset, &m->state.time, m->state.y, m->state.u);
}

static void tangent(struct instance *m, const double *dt)
{
    struct workspace *w = &m->work;
    w->argument[4] = dt;
    w->argument[5] = w->dy;
    w->argument[6] = w->du;
    w->argument[7] = w->dp;
    w->result[0] = w->df;
    w->result[1] = w->doutput;
    call(m, model_directional, &m->state.time, m->state.y, m->state.u);
}

/* Derivative of ode and outputs in the direction (dt, dx, du, dp) that the workspace holds, the algebraic unknowns
   following: the z part of `dy` is not read, but becomes dz = -(dalg/dz)^-1 dalg. */
int evaluate_directional(struct instance *m, double dt)
{
    struct workspace *w = &m->work;
    if (refresh(m, 0) != 0)
        return 1;
    memset(w->dy + NX, 0, NZ * sizeof(double));
    if (NZ > 0) {
        tangent(m, &dt);
        evaluate_algebraic(m, m->state.time, m->state.y, w->f, w->matrix);
        if (lu_factor(NZ, w->matrix, w->pivot) != 0)
            return fail(m, "the algebraic equations are singular at t = %.9g s", m->state.time);
        for (int i = 0; i < NZ; i++)
            w->dy[NX + i] = -w->df[NX + i];
        lu_solve(NZ, w->matrix, w->pivot, w->dy + NX);
    }
    tangent(m, &dt);
    return 0;
}

/* Brings the algebraic unknowns and those results up to date whose bits are set. */
int refresh(struct instance *m, uint32_t kinds)
{
    struct state *s = &m->state;
    if (!s->consistent && solve_algebraic(m) != 0)
        return 1;
    kinds &= ~m->fresh;
    m->fresh |= kinds;
    if (kinds & 1u << DERIVATIVE)
        evaluate_residual(m, s->time, s->y, m->derivative);
    if (kinds & 1u << OUTPUT) {
        m->work.result[0] = m->output;
        call(m, model_output, &s->time, s->y, s->u);
    }
    if (kinds & 1u << OBSERVABLE) {
        m->work.result[0] = m->observable;
        call(m, model_observe, &s->time, s->y, s->u);
    }
    if (kinds & 1u << INDICATOR) {
        evaluate_indicators(m, s->time, s->y, m->indicator);
        for (int i = 0; i < NE; i++)
            m->indicator[i] -= margin(m, i);
    }
    return 0;
}
