/* Displacement of a three-axis magnetic sensor below a film, from what it reads.
 *
 * Film: {layout}
 * sha256 {sha256}
{head} * Written by magsplice {version}.
 *
 * A polynomial of degree {degree} of the decoupling parameters R_x, R_y and S_z (Dai et al.,
 * Magnetochemistry 2024, 10(1), 6, Eq. 15). The length of its error is at most {error} mm in the working
 * volume, x {x}, y {y}, z {z} mm: measured at {checked} points, with a margin
 * for what is between them and for arithmetic in float. */
#ifndef MAGSPLICE_DISPLACEMENT_H
#define MAGSPLICE_DISPLACEMENT_H

#include <math.h>

#define MAGSPLICE_DEGREE {degree}
#define MAGSPLICE_TERMS {terms}

/* Least and largest R_x, R_y (radians) and S_z (of B in tesla) in the working volume. */
static const float magsplice_lower[3] = {{lower}};
static const float magsplice_upper[3] = {{upper}};

/* The flux density along the axes of the film is this matrix times the reading minus the offset, which is in
 * tesla. */
static const float magsplice_axes[3][3] = {{axes}};
static const float magsplice_offset_t[3] = {{offset}};

/* Millimetres along x, y, z for each product of Chebyshev polynomials. */
static const float magsplice_coefficients[MAGSPLICE_TERMS][3] = {
{coefficients}};

/* Finds the displacement of the sensor from the reference point ({reference}) mm, in the frame of the
 * film, in millimetres. The film has moved by the opposite. reading_t is what the sensor reads along its
 * axes, in tesla.
 *
 * Returns 0; 1 if the reading is of no place in the working volume, where the result is extrapolated;
 * or 2 if B_z is 0, which has no result. */
static inline int magsplice_displacement(const float reading_t[3], float displacement_mm[3])
{
    const float sign = {sign}f;
    float chebyshev[3][MAGSPLICE_DEGREE + 1];
    float parameters[3], b_t[3];
    float x, y, c_x, c_y;
    int axis, i, j, k, term = 0, outside = 0;

    for (i = 0; i < 3; i++) {
        b_t[i] = 0.0f;
        for (j = 0; j < 3; j++)
            b_t[i] += magsplice_axes[i][j] * (reading_t[j] - magsplice_offset_t[j]);
    }
    if (!(b_t[2] > 0.0f || b_t[2] < 0.0f)) return 2;
    x = b_t[0] / b_t[2];
    y = b_t[1] / b_t[2];
    c_x = 0.5f * b_t[2] * (1.0f + (y - x) * (y + x));
    c_y = 0.5f * b_t[2] * (1.0f - (y - x) * (y + x));
    parameters[0] = atan2f(sign * b_t[0], sign * c_x);
    parameters[1] = atan2f(sign * b_t[1], sign * c_y);
    parameters[2] = logf(hypotf(c_y, b_t[1]));

    for (axis = 0; axis < 3; axis++) {
        const float low = magsplice_lower[axis], high = magsplice_upper[axis];
        const float u = (2.0f * parameters[axis] - low - high) / (high - low);
        /* A thousandth beyond is the noise of a reading at the border. */
        if (!(u >= -1.001f && u <= 1.001f)) outside = 1;
        chebyshev[axis][0] = 1.0f;
        chebyshev[axis][1] = u;
        for (i = 2; i <= MAGSPLICE_DEGREE; i++)
            chebyshev[axis][i] = 2.0f * u * chebyshev[axis][i - 1] - chebyshev[axis][i - 2];
        displacement_mm[axis] = 0.0f;
    }
    for (i = 0; i <= MAGSPLICE_DEGREE; i++)
        for (j = 0; i + j <= MAGSPLICE_DEGREE; j++)
            for (k = 0; i + j + k <= MAGSPLICE_DEGREE; k++, term++) {
                const float value = chebyshev[0][i] * chebyshev[1][j] * chebyshev[2][k];
                for (axis = 0; axis < 3; axis++)
                    displacement_mm[axis] += value * magsplice_coefficients[term][axis];
            }
    return outside;
}

#endif
