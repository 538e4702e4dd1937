/* The filter of predictions in doubles: the formulas of `DoubleFilter`, which has their derivation, for predictions.c. */
#ifndef TRUEBREAK_FILTER_H
#define TRUEBREAK_FILTER_H

#include "reading.h"

#define ROUND_UP (1 + 64 * UNIT)
#define ROUND_DOWN (1 - 64 * UNIT)

enum { NONE, MEETS, UNCLEAR, FAILED };
enum { X, Y, VX, VY, AT, LATE, FLIGHT };

/* 4 E and F; of d.v and d x v, |v|^2 and what a `late` of 1 does to d.v: see `DoubleFilter._bound`. */
typedef struct { double near, slack, any_off, any_loose, any_early; } Bounds;

/* What changes as one circle is held against others: the larger `late` so far, and what depends on it. */
typedef struct { double late, most, close; } Against;

typedef struct { double low, high; } Span;

/* d and v of two, and d.v, at the later of their clocks. */
typedef struct { double now, dx, dy, vx, vy, approach; } Apart;

/* Whether two may come nearer at all: most do not, whatever their radii. */
static int near(const double *a, const double *b, const Bounds *bounds, Against *against, Apart *apart)
{
    double lag = a[AT] - b[AT], now, dx, dy;
    if (lag > against->close) {
        now = a[AT];
        dx = b[X] + b[VX] * lag - a[X];
        dy = b[Y] + b[VY] * lag - a[Y];
    } else {
        now = b[AT];
        dx = b[X] - (a[X] - a[VX] * lag);
        dy = b[Y] - (a[Y] - a[VY] * lag);
        if (b[LATE] > against->late) {
            against->late = b[LATE];
            against->most = bounds->any_off + bounds->any_early * against->late;
        }
    }
    double vx = b[VX] - a[VX], vy = b[VY] - a[VY];
    *apart = (Apart){now, dx, dy, vx, vy, dx * vx + dy * vy};
    return !(apart->approach > against->most);
}

static int pair(const Apart *apart, double reach, const Bounds *bounds, double late, Span *span)
{
    double dx = apart->dx, dy = apart->dy, vx = apart->vx, vy = apart->vy, approach = apart->approach;
    double cross = fabs(dx * vy - dy * vx);
    double square = vx * vx + vy * vy;
    double clear = cross - bounds->any_off;
    if (clear > 0.0 && clear * clear > (square + bounds->any_loose) * (reach * reach) * ROUND_UP)
        return NONE;
    double wide = fabs(vx) + fabs(vy);
    double off = bounds->near * wide + 10.0 * bounds->slack * (fabs(dx) + fabs(dy));
    double loose = 6.0 * bounds->slack * wide;
    double early = off + 2.0 * (square + loose) * late;
    if (approach > early)
        return NONE;
    if (!(approach < -early && square > 100.0 * loose))
        return UNCLEAR;
    if (cross > off && (cross - off) * (cross - off) > (square + loose) * (reach * reach) * ROUND_UP)
        return NONE;
    double room = (square - loose) * (reach * reach) * ROUND_DOWN;
    if ((cross + off) * (cross + off) > room || reach == 0.0)
        return UNCLEAR;
    double speed = sqrt(square);
    double doubt = loose / square + 8 * UNIT;
    double passing = cross / speed;
    double depth = sqrt(reach * reach - passing * passing);
    double ahead = -approach / speed;
    off /= speed;
    double off_passing = off + passing * doubt;
    double off_depth = (2.0 * passing * off_passing + off_passing * off_passing + 8 * UNIT * reach * reach) / depth;
    double wait = (ahead - depth) / speed;
    double off_wait = (off + off_depth + (ahead + depth) * (doubt + 4 * UNIT)) / speed + fabs(wait) * doubt;
    double time = apart->now + wait;
    double off_time = 2.0 * off_wait + 8 * UNIT * (apart->now + fabs(wait));
    if (!(wait > off_time + late) || !isfinite(time))
        return UNCLEAR;
    span->low = time - off_time;
    span->high = time + off_time;
    return MEETS;
}

/* A line is (x0, y0, nx, ny, offset, norm, size). */
static int wall(const double *a, const double *line, double flat, double far, Span *span)
{
    double x0 = line[0], y0 = line[1], nx = line[2], ny = line[3], offset = line[4], norm = line[5], size = line[6];
    double approach = nx * a[VX] + ny * a[VY];
    double off = norm * flat;
    if (approach > off)
        return NONE;
    double gap = nx * (a[X] - x0) + ny * (a[Y] - y0) - offset;
    double off_gap = 32 * UNIT * size + norm * far;
    if (!(approach < -8.0 * off && gap > off_gap))
        return UNCLEAR;
    double wait = -gap / approach;
    double off_wait = (off_gap + wait * off) / -approach + 8 * UNIT * wait;
    double time = a[AT] + wait;
    double off_time = 2.0 * off_wait + 8 * UNIT * (a[AT] + wait);
    if (!(wait > off_time + a[LATE]) || !isfinite(time))
        return UNCLEAR;
    span->low = time - off_time;
    span->high = time + off_time;
    return MEETS;
}

/* As `wall`, of a face: see `DoubleFilter.faces`. */
static int face(const double *a, const double *line, double flat, double far, Span *span)
{
    double x0 = line[0], y0 = line[1], nx = line[2], ny = line[3], offset = line[4], norm = line[5], size = line[6];
    double x = a[X], y = a[Y], vx = a[VX], vy = a[VY], t = a[AT], late = a[LATE];
    double approach = nx * vx + ny * vy;
    double blur = norm * flat;
    if (approach > blur)
        return NONE;
    double gap = nx * (x - x0) + ny * (y - y0) - offset;
    double blur_gap = 32 * UNIT * size + norm * far;
    double early = blur_gap + 2.0 * (fabs(approach) + blur) * late;
    if (gap < -early)
        return NONE;
    if (!(approach < -8.0 * blur && gap > blur_gap))
        return UNCLEAR;
    double wait = -gap / approach;
    double blur_wait = (blur_gap + wait * blur) / -approach + 8 * UNIT * wait;
    double time = t + wait;
    double blur_time = 2.0 * blur_wait + 8 * UNIT * (t + wait);
    if (!(wait > blur_time + late) || !isfinite(time))
        return UNCLEAR;
    double along = (x - x0) * ny - (y - y0) * nx, slide = vx * ny - vy * nx;
    double foot = along + slide * wait, beyond = nx * nx + ny * ny;
    double blur_foot = blur_gap + wait * blur + (fabs(slide) + blur) * 2.0 * blur_wait;
    blur_foot = 2.0 * blur_foot + 16 * UNIT * (fabs(along) + fabs(slide) * wait + beyond);
    if (foot < -blur_foot || foot > beyond + blur_foot)
        return NONE;
    if (!(foot > blur_foot && foot < beyond - blur_foot))
        return UNCLEAR;
    span->low = time - blur_time;
    span->high = time + blur_time;
    return MEETS;
}

/* A wall that falls or moves, or a face under gravity: `FloatFall`, which has what these are. */
typedef struct { double x0, y0, nx, ny, offset, norm, size, half, drift, bend; int is_face; } Falls;

/* As `wall`: `fall_in_doubles` of filtered_falls.py, which has the derivation. */
static int fall(const double *a, const Falls *line, double flat, double far, int stands, Span *span)
{
    double x0 = line->x0, y0 = line->y0, nx = line->nx, ny = line->ny, half = line->half, drift = line->drift;
    double x = a[X], y = a[Y], vx = a[VX], vy = a[VY], t = a[AT], late = a[LATE], wait, blur_wait;
    double lift = half * t;
    double gap = nx * (x - x0) + ny * (y - y0) - line->offset + (lift - drift) * t;
    double speed = nx * vx + ny * vy + (2.0 * lift - drift);
    double grown = fabs(lift) + fabs(drift);
    double blur = line->norm * flat + 32 * UNIT * grown;
    double blur_gap = 32 * UNIT * line->size + line->norm * far + 32 * UNIT * grown * t;
    double turn = blur + 4.0 * fabs(half) * late;
    if (stands) {
        if (half >= 0.0)
            return NONE;
        if (!(speed > 8.0 * turn))
            return UNCLEAR;
        wait = speed / -half;
        blur_wait = blur / -half + late + 8 * UNIT * wait;
    } else {
        double early = blur_gap + 2.0 * (fabs(speed) + turn) * late;
        if (half >= 0.0 && speed > turn)
            return NONE;
        if (line->is_face && gap < -early && (half >= 0.0 || speed < -turn))
            return NONE;
        if (half == 0.0) {
            if (!(speed < -8.0 * turn && gap > early))
                return UNCLEAR;
            wait = gap / -speed;
            blur_wait = (blur_gap + wait * blur) / -speed + 8 * UNIT * wait;
        } else {
            double depth = 4.0 * half * gap;
            double square = speed * speed;
            double disc = square - depth;
            double blur_disc = (2.0 * fabs(speed) + blur) * blur + 4.0 * fabs(half) * blur_gap;
            blur_disc = 2.0 * (blur_disc + 8 * UNIT * (square + fabs(depth)));
            if (disc < -blur_disc && (line->is_face || half > 0.0))
                return NONE;
            if (!(disc > 4.0 * blur_disc))
                return UNCLEAR;
            if (!(gap > early && (half < 0.0 || speed < -turn)) && !(line->is_face && half < 0.0 && speed > turn))
                return UNCLEAR;
            double root = sqrt(disc);
            double blur_root = blur_disc / root + 4 * UNIT * root;
            if (speed < 0.0) {
                double fast = root - speed;
                double blur_fast = blur_root + blur + 2 * UNIT * fast;
                if (!(fast > 8.0 * blur_fast))
                    return UNCLEAR;
                wait = 2.0 * gap / fast;
                blur_wait = (2.0 * blur_gap + wait * blur_fast) / fast + 8 * UNIT * wait;
            } else {
                wait = (speed + root) / (-2.0 * half);
                blur_wait = (blur + blur_root) / (-2.0 * half) + 8 * UNIT * wait;
            }
        }
    }
    double time = t + wait;
    double blur_time = 2.0 * blur_wait + 8 * UNIT * (t + wait);
    if (!(wait > blur_time + late) || !isfinite(time))
        return UNCLEAR;
    if (line->is_face) {
        double bend = line->bend;
        double along = (x - x0) * ny - (y - y0) * nx + bend * t * t, slide = vx * ny - vy * nx + 2.0 * bend * t;
        double arch = bend * wait;
        double foot = along + (slide + arch) * wait, beyond = nx * nx + ny * ny;
        double tilt = fabs(bend) * t;
        double blur_slide = line->norm * flat + 32 * UNIT * tilt;
        double blur_foot = 32 * UNIT * (line->size + tilt * t) + line->norm * far + wait * blur_slide;
        double fast = fabs(slide) + blur_slide + 2.0 * fabs(arch) + 2.0 * fabs(bend) * blur_time;
        blur_foot += fast * 2.0 * blur_wait;
        blur_foot = 2.0 * blur_foot + 16 * UNIT * (fabs(along) + (fabs(slide) + fabs(arch)) * wait + beyond);
        if (foot < -blur_foot || foot > beyond + blur_foot)
            return NONE;
        if (!(foot > blur_foot && foot < beyond - blur_foot))
            return UNCLEAR;
    }
    span->low = time - blur_time;
    span->high = time + blur_time;
    return MEETS;
}

static Against against(const double *a, const Bounds *bounds)
{
    return (Against){a[LATE], bounds->any_off + bounds->any_early * a[LATE], 4 * UNIT * a[AT]};
}

#endif
