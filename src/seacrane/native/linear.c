/* Linear systems: dense ones, and that of an implicit step, (s M - df/dy) x = b with M = diag(1 for states, 0 for algebraic
   unknowns).

   The latter is mostly zeros. It is solved by the straight code that seacrane.model.elimination has made for it; as that
   seeks no pivots, its first solution is put to the test, and if it fails the matrix is factored again in full. */
#include "core.h"

#include <math.h>
#include <string.h>

#define NEAR 1e-10 /* by which share of its terms an equation may be missed */

/* LU factorisation with partial pivoting (Golub & Van Loan, Matrix Computations, algorithm 3.4.1). Factors the
   row-major n x n matrix `a` in place. If it is singular or not finite, returns the number of the column (from one on) where
   that shows. */
int lu_factor(int n, double *a, int *pivot)
{
    for (int k = 0; k < n; k++) {
        int best = k;
        double largest = fabs(a[k * n + k]);
        for (int i = k + 1; i < n; i++) {
            double size = fabs(a[i * n + k]);
            if (size > largest) {
                largest = size;
                best = i;
            }
        }
        pivot[k] = best;
        if (!(largest > 0 && largest < HUGE_VAL))
            return k + 1;
        if (best != k) {
            for (int j = 0; j < n; j++) {
                double swap = a[best * n + j];
                a[best * n + j] = a[k * n + j];
                a[k * n + j] = swap;
            }
        }
        double reciprocal = 1 / a[k * n + k];
        for (int i = k + 1; i < n; i++) {
            double factor = a[i * n + k];
            if (factor == 0)
                continue;
            factor *= reciprocal;
            a[i * n + k] = factor;
            for (int j = k + 1; j < n; j++)
                a[i * n + j] -= factor * a[k * n + j];
        }
    }
    return 0;
}

/* Solves with the factors of lu_factor; `b` becomes the solution. */
void lu_solve(int n, const double *a, const int *pivot, double *b)
{
    for (int k = 0; k < n; k++) {
        double swap = b[k];
        b[k] = b[pivot[k]];
        b[pivot[k]] = swap;
    }
    for (int i = 1; i < n; i++) {
        double sum = b[i];
        for (int j = 0; j < i; j++)
            sum -= a[i * n + j] * b[j];
        b[i] = sum;
    }
    for (int i = n - 1; i >= 0; i--) {
        double sum = b[i];
        for (int j = i + 1; j < n; j++)
            sum -= a[i * n + j] * b[j];
        b[i] = sum / a[i * n + i];
    }
}

/* Whether x solves the system as it would with entries that are changed in their tenth digit. This depends neither on the
   units of the unknowns nor on those of the equations (W. Oettli and W. Prager, Numerische Mathematik 6, 1964). */
static int solves(struct instance *m, double s, const double *b, const double *x)
{
    struct workspace *w = &m->work;
    for (int i = 0; i < N; i++) {
        double term = i < NX ? s * x[i] : 0;
        w->misfit[i] = b[i] - term;
        w->size[i] = fabs(b[i]) + fabs(term);
    }
    for (int k = 0; k < NNZ; k++) {
        double term = w->nonzeros[k] * x[model_column[k]];
        w->misfit[model_row[k]] += term;
        w->size[model_row[k]] += fabs(term);
    }
    for (int i = 0; i < N; i++)
        if (!(fabs(w->misfit[i]) <= NEAR * w->size[i]))
            return 0;
    return 1;
}

/* Factors the matrix with the Jacobian in the workspace, and solves with it for the first time. If it is singular, returns
   the number of the column (from one on) where that shows. */
int matrix_factor(struct instance *m, double s, const double *b, double *x)
{
    struct workspace *w = &m->work;
    m->statistics.factorizations++;
    w->pivoted = NFACTORS == 0;
    if (!w->pivoted) {
        w->argument[0] = w->nonzeros;
        w->argument[1] = &s;
        w->result[0] = w->factors;
        model_factor(w->argument, w->result, w->iw, w->w, 0);
        matrix_solve(m, b, x);
        if (solves(m, s, b, x))
            return 0;
        w->pivoted = 1;
    }
    memset(w->matrix, 0, sizeof w->matrix);
    for (int k = 0; k < NNZ; k++)
        w->matrix[model_row[k] * N + model_column[k]] = -w->nonzeros[k];
    for (int i = 0; i < NX; i++)
        w->matrix[i * (N + 1)] += s;
    int lost = lu_factor(N, w->matrix, w->pivot);
    if (lost == 0)
        matrix_solve(m, b, x);
    return lost;
}

/* Solves with the matrix that has been factored; x and b are different places. */
void matrix_solve(struct instance *m, const double *b, double *x)
{
    struct workspace *w = &m->work;
    if (w->pivoted) {
        memcpy(x, b, N * sizeof(double));
        lu_solve(N, w->matrix, w->pivot, x);
        return;
    }
    w->argument[0] = w->factors;
    w->argument[1] = b;
    w->result[0] = x;
    model_solve(w->argument, w->result, w->iw, w->w, 0);
}
