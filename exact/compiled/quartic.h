/* The first zero at which a quartic falls, in doubles: what `falling_zero` of round_falls.py does, which has the
 * derivation; of a circle that falls onto one that stands: `peg_in_doubles` of filtered_falls.py; and onto a side of an
 * arc: `side_in_doubles` of filtered_arcs.py. */
#ifndef TRUEBREAK_QUARTIC_H
#define TRUEBREAK_QUARTIC_H

#include "filter.h"

enum { DEGREE = 4, TERMS = DEGREE + 1, DEEPEST = 40, MOST_PARTS = 200, NEWTONS = 60, WIDENINGS = 8 };

#define SMALLEST 1e-280
#define LEAST 1e-60
#define GREATEST 1e60
#define NARROW 0x1p-24

static const double primes[] = {131, 137, 139, 149, 151, 157, 163, 167, 173, 179, 181, 191, 193, 197,
                                199, 211, 223, 227, 229, 233, 239, 241, 251, 257};

/* C(i, j) / C(n, j): `WEIGHTS`. */
static const double weights[TERMS][TERMS][TERMS] = {
    {{1.0}},
    {{1.0}, {1.0, 1.0}},
    {{1.0}, {1.0, 1.0 / 2.0}, {1.0, 1.0, 1.0}},
    {{1.0}, {1.0, 1.0 / 3.0}, {1.0, 2.0 / 3.0, 1.0 / 3.0}, {1.0, 1.0, 1.0, 1.0}},
    {{1.0}, {1.0, 1.0 / 4.0}, {1.0, 1.0 / 2.0, 1.0 / 6.0}, {1.0, 3.0 / 4.0, 1.0 / 2.0, 1.0 / 4.0}, {1.0, 1.0, 1.0, 1.0, 1.0}},
};

/* A polynomial: its degree, its coefficients, the constant one first, and bounds of their errors. */
typedef struct { int degree; double c[TERMS], off[TERMS]; } Poly;

static double value_of(const Poly *p, double t)
{
    double found = 0.0;
    for (int k = p->degree; k >= 0; k--)
        found = found * t + p->c[k];
    return found;
}

static double slope_of(const Poly *p, double t)
{
    double found = 0.0;
    for (int k = p->degree; k > 0; k--)
        found = found * t + k * p->c[k];
    return found;
}

static double doubt_of(const Poly *p, double t)
{
    double found = 0.0;
    for (int k = p->degree; k >= 0; k--)
        found = found * t + (fabs(p->c[k]) * 16 * UNIT + p->off[k]);
    return 1.01 * found;
}

/* A double beyond all positive zeros: 0 where there are none, infinite where unknown. */
static double last_zero(const Poly *p)
{
    int degree = p->degree, some = 0;
    while (degree && p->c[degree] == 0.0 && p->off[degree] == 0.0)
        degree--;
    double lead = fabs(p->c[degree]) - p->off[degree], most = 0.0;
    for (int k = 1; k <= degree; k++)
        some = some || !(p->c[k] >= p->off[k]);
    if (!some)
        return 0.0;
    if (!(lead > 0.0))
        return INFINITY;
    int falls = p->c[degree] < 0.0;
    for (int k = falls ? 0 : 1; k < degree; k++)
        if (falls || !(p->c[k] >= p->off[k])) {
            double size = falls ? fabs(p->c[k]) + p->off[k] : p->off[k] - p->c[k];
            double root = pow(size / lead, 1.0 / (degree - k));
            if (root > most)
                most = root;
        }
    return 2.000001 * most;
}

/* A prime times a power of 2, at least a double. */
static double end_of(double last)
{
    int power, k = 0;
    double wanted = frexp(last, &power) * 256.0;
    while (primes[k] < wanted)
        k++;
    return ldexp(primes[k], power - 8);
}

static Span sharpened(const Poly *p, double low, double high)
{
    double a = low, b = high, t = 0.5 * (a + b);
    for (int k = 0; k < NEWTONS; k++) {
        double value = value_of(p, t), slope = slope_of(p, t);
        if (value > 0.0)
            a = t;
        else
            b = t;
        double near = slope != 0.0 ? t - value / slope : INFINITY;
        if (!(a < near && near < b))
            near = 0.5 * (a + b);
        int done = fabs(near - t) <= 4 * UNIT * t;
        t = near;
        if (done)
            break;
    }
    double slope = slope_of(p, t);
    if (slope >= 0.0)
        return (Span){low, high};
    double width = 2.0 * doubt_of(p, t) / -slope + 4 * UNIT * t;
    for (int k = 0; k < WIDENINGS; k++) {
        double x = low > t - width ? low : t - width, y = high < t + width ? high : t + width;
        if ((x == low || value_of(p, x) > doubt_of(p, x)) && (y == high || value_of(p, y) < -doubt_of(p, y)))
            return (Span){x, y};
        width *= 4.0;
    }
    return (Span){low, high};
}

/* An interval that is still to be looked at, with the Bernstein coefficients there. */
typedef struct { double low, high, b[TERMS]; int depth; } Part;

/* Begins with all times up to a polynomial's last falling zero, or an end: `started`. */
static int started(const Poly *p, double end, Part *part, double *base, double *per)
{
    int degree = p->degree;
    double last = last_zero(p);
    if (last == 0.0)
        return NONE;
    if (!(last < end))
        last = end;
    if (!(LEAST < last && last < GREATEST))
        return UNCLEAR;
    double top = end_of(last), size = 0.0, slack = 0.0, power = 1.0, terms[TERMS];
    for (int k = 0; k <= degree; k++) {
        size += fabs(p->c[k]) * power;
        slack += p->off[k] * power;
        terms[k] = p->c[k] * power;
        power *= top;
    }
    if (!(SMALLEST < size && size < 1 / SMALLEST))
        return UNCLEAR;
    *base = 1.01 * slack + 64 * UNIT * size;
    *per = 8 * UNIT * size;
    *part = (Part){0.0, top, {0.0}, 0};
    for (int i = 0; i <= degree; i++) {
        double sum = 0.0;
        for (int j = 0; j <= i; j++)
            sum += weights[degree][i][j] * terms[j];
        part->b[i] = sum;
    }
    return MEETS;
}

/* Both halves of a part, the later one first. */
static void halve(Part part, int degree, Part *halves)
{
    Part *right = &halves[0], *first = &halves[1];
    for (int k = 0; k <= degree; k++) {
        first->b[k] = part.b[0];
        right->b[degree - k] = part.b[degree - k];
        for (int m = 0; m < degree - k; m++)
            part.b[m] = (part.b[m] + part.b[m + 1]) * 0.5;
    }
    first->low = part.low;
    right->high = part.high;
    first->high = right->low = 0.5 * (part.low + part.high);
    right->depth = first->depth = part.depth + 1;
}

/* How often the signs of a part's coefficients change, after a first one; -1 where one of them is not certain. */
static int changes_of(const Part *part, int degree, double doubt, int above)
{
    int changes = 0;
    for (int k = 0; k <= degree; k++) {
        if (part->b[k] > doubt) {
            changes += !above;
            above = 1;
        } else if (part->b[k] < -doubt) {
            changes += above;
            above = 0;
        } else
            return -1;
    }
    return changes;
}

/* The first zero in (0, end], or a little beyond, at which a polynomial falls from above zero: MEETS; UNCLEAR: it is not
 * told, and none comes before `span->low`. */
static int falling_zero(const Poly *p, double end, Span *span)
{
    int degree = p->degree;
    span->low = span->high = 0.0;
    int plain = p->c[0] > p->off[0];
    for (int k = 0; k <= degree; k++)
        plain = plain && isfinite(p->c[k]) && isfinite(p->off[k]);
    if (!plain)
        return UNCLEAR;
    Part stack[DEEPEST + 2];
    double base, per;
    int told = started(p, end, stack, &base, &per);
    if (told != MEETS)
        return told;
    int left = 1, parts = 0;
    while (left > 0) {
        Part part = stack[--left];
        int changes = changes_of(&part, degree, base + per * part.depth, 1);
        if (changes == 0)
            continue;
        if (changes == 1) {
            *span = sharpened(p, part.low, part.high);
            return MEETS;
        }
        parts++;
        if (part.depth >= DEEPEST || parts > MOST_PARTS) {
            span->low = part.low;
            return UNCLEAR;
        }
        halve(part, degree, &stack[left]);
        left += 2;
    }
    return NONE;
}

/* A circle that stands, as one that falls meets it: `FloatPeg`. */
typedef struct { double x, y, reach, hx, hy; } Peg;

/* A flight as something round sees it that stands, from the flight's clock on: the gap, and what it is made of. */
typedef struct { Poly gap; double ex, ey, ux, uy, near, fast, pull, off_e, off_v; } Seen;

static Seen seen_from(const double *a, const Peg *peg)
{
    double x = a[X], y = a[Y], vx = a[VX], vy = a[VY], t = a[AT], late = a[LATE], hx = peg->hx, hy = peg->hy;
    double wx = hx * t, wy = hy * t;
    double ex = x - peg->x + wx * t, ey = y - peg->y + wy * t;
    double ux = vx + 2.0 * wx, uy = vy + 2.0 * wy;
    double near = fabs(ex) + fabs(ey), fast = fabs(ux) + fabs(uy), pull = fabs(hx) + fabs(hy);
    double sunk = fabs(wx) + fabs(wy);
    double off_v = 16 * UNIT * (fabs(vx) + fabs(vy) + 2.0 * sunk);
    double off_e = 32 * UNIT * (fabs(x) + fabs(y) + fabs(peg->x) + fabs(peg->y) + sunk * t);
    off_e += 2.0 * late * (fast + off_v + pull * late);
    off_v += 4.0 * pull * late;
    Poly p = {DEGREE,
              {ex * ex + ey * ey - peg->reach * peg->reach, 2.0 * (ex * ux + ey * uy),
               ux * ux + uy * uy + 2.0 * (ex * hx + ey * hy), 2.0 * (ux * hx + uy * hy), hx * hx + hy * hy},
              {4.0 * off_e * (near + off_e) + 16 * UNIT * (near * near + peg->reach * peg->reach),
               4.0 * (off_e * (fast + off_v) + near * off_v) + 16 * UNIT * near * fast,
               4.0 * off_v * (fast + off_v) + 4.0 * pull * off_e + 16 * UNIT * (fast * fast + 2.0 * near * pull),
               4.0 * pull * off_v + 16 * UNIT * fast * pull, 16 * UNIT * pull * pull}};
    return (Seen){p, ex, ey, ux, uy, near, fast, pull, off_e, off_v};
}

/* Divides out the zero at 0. */
static void divide_out(Poly *p)
{
    p->degree--;
    for (int k = 0; k < DEGREE; k++) {
        p->c[k] = p->c[k + 1];
        p->off[k] = p->off[k + 1];
    }
}

/* What a flight can last for. */
static double left_of(const double *a, double until)
{
    return until - a[AT] + (a[LATE] + 8 * UNIT * (until + a[AT]));
}

/* From the clock on to times as they are. */
static int as_times(const double *a, Span *span)
{
    double t = a[AT], late = a[LATE], low = span->low, high = span->high;
    if (!(high - low <= NARROW * high))
        return UNCLEAR;
    span->low = t + low - (late + 8 * UNIT * (t + low));
    span->high = t + high + (late + 8 * UNIT * (t + high));
    return isfinite(span->high) ? MEETS : UNCLEAR;
}

static int onto_peg(const double *a, const Peg *peg, double until, int stood, Span *span)
{
    double end = left_of(a, until);
    if (end <= 0.0)
        return NONE;
    if (!isfinite(peg->reach)) /* which drops out where they touch as the flight begins */
        return UNCLEAR;
    Seen seen = seen_from(a, peg);
    if (stood)
        divide_out(&seen.gap);
    int told = falling_zero(&seen.gap, end, span);
    return told == MEETS ? as_times(a, span) : told;
}

/* A side of an arc, as a circle that falls meets it: `FallenSide`. */
typedef struct { Peg about; double nx, ny, edge, norm; int full; } Side;

/* Whether a circle at a side's distance is within its range, at all of some times: MEETS; at none: NONE. */
static int within(const Seen *seen, const Side *side, double low, double high)
{
    if (side->full)
        return MEETS;
    double s = 0.5 * (low + high), spread = 0.5 * (high - low) + 4 * UNIT * high;
    double x = seen->ex + (seen->ux + side->about.hx * s) * s, y = seen->ey + (seen->uy + side->about.hy * s) * s;
    double found = side->nx * x + side->ny * y - side->edge;
    double off = side->norm * (seen->off_e + high * seen->off_v);
    off += side->norm * (seen->fast + seen->off_v + 2.0 * seen->pull * high) * spread;
    off += 32 * UNIT * (side->norm * (seen->near + (seen->fast + seen->pull * high) * high) + fabs(side->edge));
    off *= 2.0;
    return found > off ? MEETS : found < -off ? NONE : UNCLEAR;
}

static int onto_side(const double *a, const Side *side, double until, int stood, Span *span)
{
    double end = left_of(a, until), base, per;
    if (end <= 0.0)
        return NONE;
    if (!isfinite(side->norm))
        return UNCLEAR;
    Seen seen = seen_from(a, &side->about);
    Poly *p = &seen.gap;
    if (side->about.reach < 0.0)
        for (int k = 0; k < TERMS; k++)
            p->c[k] = -p->c[k];
    if (stood)
        divide_out(p);
    int degree = p->degree, plain = 1;
    for (int k = 0; k <= degree; k++)
        plain = plain && isfinite(p->c[k]) && isfinite(p->off[k]);
    Part stack[DEEPEST + 2];
    int told = plain ? started(p, end, stack, &base, &per) : UNCLEAR;
    if (told != MEETS)
        return told;
    int left = 1, parts = 0;
    while (left > 0) {
        Part part = stack[--left];
        int above = part.b[0] > 0.0, changes = changes_of(&part, degree, base + per * part.depth, above);
        if (changes == 0 || (changes == 1 && !above))
            continue;
        if (changes == 1) {
            *span = sharpened(p, part.low, part.high);
            int there = within(&seen, side, span->low, span->high);
            if (there == NONE)
                continue;
            return there == MEETS ? as_times(a, span) : UNCLEAR;
        }
        if (within(&seen, side, part.low, part.high) == NONE)
            continue;
        parts++;
        if (part.depth >= DEEPEST || parts > MOST_PARTS)
            return UNCLEAR;
        halve(part, degree, &stack[left]);
        left += 2;
    }
    return NONE;
}

#endif
