/* The rows of an error set at the end of a block: what `_maps` and `ErrorSet._carried` do, for steps.c. */
#ifndef TRUEBREAK_ROWS_H
#define TRUEBREAK_ROWS_H

#include "reading.h"

enum { COORDINATES = 4 }; /* x, y, vx, vy */

/* What is kept of a collision: see `PARTS` in error_set.py. */
enum { LEGS = 10, PARTS = 19 };

enum { BLOCKS = 7, BOTH = 2 * COORDINATES };

typedef double Four[COORDINATES][COORDINATES];

/* The matrix of legs: (T, T l; 0, T). */
static void flown(const double *legs, Four out)
{
    memset(out, 0, sizeof(Four));
    for (int k = 0; k < 2; k++)
        for (int m = 0; m < 2; m++) {
            double turned = legs[2 * k + m];
            out[k][m] = out[2 + k][2 + m] = turned;
            out[k][2 + m] = turned * legs[4];
        }
}

/* One matrix times another, rows at a time: `rows` of them at `from`, as wide as is said. */
static void times(const double *matrix, int size, const double *const *from, double *out, Py_ssize_t width)
{
    for (int row = 0; row < size; row++) {
        double *sum = out + row * width;
        for (Py_ssize_t c = 0; c < width; c++)
            sum[c] = matrix[row * size] * from[0][c];
        for (int k = 1; k < size; k++)
            for (Py_ssize_t c = 0; c < width; c++)
                sum[c] += matrix[row * size + k] * from[k][c];
    }
}

/* `_maps`, of one collision, whose blocks stand so many numbers apart. */
static void map_of(const double *hit, const double *block, Py_ssize_t apart, double out[BOTH][BOTH])
{
    double xx = block[0], xy = block[apart], yy = block[2 * apart];
    const Four c = {{xx, xy, 0.0, 0.0}, {xy, yy, 0.0, 0.0}, {block[3 * apart], block[4 * apart], xx, xy},
                    {block[5 * apart], block[6 * apart], xy, yy}};
    Four legs[2], after[2];
    for (int k = 0; k < 2; k++) {
        flown(hit + k * (LEGS / 2), legs[k]);
        const double *from[COORDINATES] = {legs[k][0], legs[k][1], legs[k][2], legs[k][3]};
        times(&c[0][0], COORDINATES, from, &after[k][0][0], COORDINATES);
    }
    for (int k = 0; k < 2; k++)
        for (int row = 0; row < COORDINATES; row++)
            for (int m = 0; m < COORDINATES; m++) {
                double weight = hit[LEGS + k];
                out[COORDINATES * k + row][COORDINATES * k + m] = legs[k][row][m] + weight * after[k][row][m];
                out[COORDINATES * k + row][COORDINATES * (1 - k) + m] = -weight * after[1 - k][row][m];
            }
}

/* Rows of fours, a body's after another's. */
typedef struct { double *numbers, *scratch; Py_ssize_t bodies, width; } Rows;

/* Takes the rows of some bodies through a matrix; -1 with an error set. */
static int turn_rows(const Rows *rows, const Py_ssize_t *bodies, int count, const double *matrix)
{
    const double *from[BOTH];
    for (int k = 0; k < count; k++) {
        Py_ssize_t body = bodies[k] < 0 ? bodies[k] + rows->bodies : bodies[k]; /* what is fixed comes last */
        if (body < 0 || body >= rows->bodies) {
            PyErr_SetString(PyExc_IndexError, "no such body among the rows");
            return -1;
        }
        for (int m = 0; m < COORDINATES; m++)
            from[COORDINATES * k + m] = rows->numbers + (COORDINATES * body + m) * rows->width;
    }
    times(matrix, COORDINATES * count, from, rows->scratch, rows->width);
    for (int k = 0; k < COORDINATES * count; k++)
        memcpy((double *)from[k], rows->scratch + k * rows->width, sizeof(double) * rows->width);
    return 0;
}

static int carry_rows(const Rows *rows, PyObject *pairs, const double *hits, const double *blocks, PyObject *pending)
{
    Py_ssize_t count = PyList_GET_SIZE(pairs) / 2;
    for (Py_ssize_t hit = 0; hit < count; hit++) {
        Py_ssize_t both[2];
        double map[BOTH][BOTH];
        map_of(hits + hit * PARTS, blocks + hit, count, map);
        if (read_size(PyList_GET_ITEM(pairs, 2 * hit), &both[0]) < 0
            || read_size(PyList_GET_ITEM(pairs, 2 * hit + 1), &both[1]) < 0 || turn_rows(rows, both, 2, &map[0][0]) < 0)
            return -1;
    }
    for (Py_ssize_t body = 0; body < PyList_GET_SIZE(pending); body++) {
        double legs[LEGS / 2];
        Four map;
        if (read_doubles(PyList_GET_ITEM(pending, body), LEGS / 2, legs) < 0)
            return -1;
        flown(legs, map);
        if (turn_rows(rows, &body, 1, &map[0][0]) < 0)
            return -1;
    }
    return 0;
}

#endif
