/* Dense LU factorisation with partial pivoting (Golub & Van Loan, Matrix Computations, algorithm 3.4.1).

   The Jacobian of a circuit is mostly zeros, and in the order of elimination that seacrane.model.codegen finds most of
   them survive. They are skipped: rows that need no elimination, columns in which the pivot row is zero, and in the
   solution all that `struct factors` does not list. */
#include <math.h>

#include "core.h"

/* Factors the row-major n x n matrix `a` in place. If it is singular or not finite, returns the number of the column (from
   one on) where that shows. */
int lu_factor(int n, double *a, int *pivot)
{
    int column[ROOM(N)];
    for (int k = 0; k < n; k++) {
        int best = k, columns = 0;
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
        if (n > DENSE_UP_TO)
            for (int j = k + 1; j < n; j++)
                if (a[k * n + j] != 0)
                    column[columns++] = j;
        for (int i = k + 1; i < n; i++) {
            double factor = a[i * n + k];
            if (factor == 0)
                continue;
            factor *= reciprocal;
            a[i * n + k] = factor;
            if (n > DENSE_UP_TO)
                for (int c = 0; c < columns; c++)
                    a[i * n + column[c]] -= factor * a[k * n + column[c]];
            else
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

/* Lists what is not zero in the N x N factors, for solving many times. Row `place[i]` was equation i before rows were
   exchanged. */
void lu_compress(const double *a, const int *pivot, const int *place, struct factors *f)
{
    int next = 0;
    for (int i = 0; i < N; i++)
        f->row[place[i]] = i;
    for (int k = 0; k < N; k++) {
        int swap = f->row[k];
        f->row[k] = f->row[pivot[k]];
        f->row[pivot[k]] = swap;
    }
    for (int i = 0; i < N; i++) {
        f->lower[i] = next;
        for (int j = 0; j < i; j++)
            if (a[i * N + j] != 0) {
                f->column[next] = j;
                f->value[next++] = a[i * N + j];
            }
        f->upper[i] = next;
        for (int j = i + 1; j < N; j++)
            if (a[i * N + j] != 0) {
                f->column[next] = j;
                f->value[next++] = a[i * N + j];
            }
        f->reciprocal[i] = 1 / a[i * N + i];
    }
    f->lower[N] = next;
}

/* Solves with the listed factors: `b` in the order of equations, `x` in the order of elimination. */
void lu_solve_compressed(const struct factors *f, const double *b, double *x)
{
    for (int i = 0; i < N; i++) {
        double sum = b[f->row[i]];
        for (int e = f->lower[i]; e < f->upper[i]; e++)
            sum -= f->value[e] * x[f->column[e]];
        x[i] = sum;
    }
    for (int i = N - 1; i >= 0; i--) {
        double sum = x[i];
        for (int e = f->upper[i]; e < f->lower[i + 1]; e++)
            sum -= f->value[e] * x[f->column[e]];
        x[i] = sum * f->reciprocal[i];
    }
}
