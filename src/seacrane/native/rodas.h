/* RODAS, a Rosenbrock method of order 4 with an error estimate of order 3, L-stable and stiffly accurate, in the transformed
   form that needs no products with the Jacobian: Hairer & Wanner, Solving Ordinary Differential Equations II, sections IV.7
   (formula 7.25) and VI.4 (table 4.2, and their program RODAS). */
#ifndef SEACRANE_RODAS_H
#define SEACRANE_RODAS_H

#include <math.h>

#define STAGES 6
#define GAMMA 0.25

static const double A[STAGES][STAGES - 1] = {
    {0},
    {1.544000000000000},
    {0.9466785280815826, 0.2557011698983284},
    {3.314825187068521, 2.896124015972201, 0.9986419139977817},
    {1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950},
    {1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950, 1},
};
static const double C[STAGES][STAGES - 1] = {
    {0},
    {-5.668800000000000},
    {-2.430093356833875, -0.2063599157091915},
    {-0.1073529058151375, -9.594562251023355, -20.47028614809616},
    {7.496443313967647, -10.24680431464352, -33.99990352819905, 11.70890893206160},
    {8.083246795921522, -7.981132988064893, -31.52159432874371, 16.31930543123136, -6.058818238834054},
};
static const double ALPHA[STAGES] = {0, 0.386, 0.21, 0.63, 1, 1};
static const double DELTA[STAGES] = {0.25, -0.1043, 0.1035, -0.0362000000000023, 0, 0};
static const double DENSE[2][STAGES - 1] = { /* of the solution within a step, of order 3 */
    {10.12623508344586, -7.487995877610167, -34.80091861555747, -7.992771707568823, 1.025137723295662},
    {-0.6762803392806887, 6.087714651680015, 16.43084320892478, 24.76722511418386, -6.594389125716872},
};

/* By which factor the step size may change after a step of this error, of order 4. Square roots are rounded alike by
   every C library, pow is not: so the same steps are taken on all platforms. */
static inline double growth(double error)
{
    return 0.9 / sqrt(sqrt(error));
}

#endif
