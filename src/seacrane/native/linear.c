/* Dense LU factorisation with partial pivoting (Golub & Van Loan, Matrix Computations, algorithm 3.4.1).

   Rows that need no elimination in a column are skipped: the Jacobian of a circuit is mostly zeros, and most of them
   survive the factorisation. */
#include <math.h>

#include "core.h"

/* Factors the row-major n x n matrix `a` in place; returns 1 if it is singular or not finite. */
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
            return 1;
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
