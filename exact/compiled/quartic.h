/* The first zero at which a quartic falls, in doubles: what `falling_zero` of round_falls.py does, which has the
 * derivation; and of a circle that falls onto one that stands: `peg_in_doubles` of filtered_falls.py. */
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
    double last = last_zero(p);
    if (last == 0.0)
        return NONE;
    if (!(last < end))
        last = end;
    if (!(LEAST < last && last < GREATEST))
        return UNCLEAR;
    double top = end_of(last), size = 0.0, slack = 0.0, power = 1.0;
    Part stack[DEEPEST + 2];
    double terms[TERMS];
    for (int k = 0; k <= degree; k++) {
        size += fabs(p->c[k]) * power;
        slack += p->off[k] * power;
        terms[k] = p->c[k] * power;
        power *= top;
    }
    if (!(SMALLEST < size && size < 1 / SMALLEST))
        return UNCLEAR;
    double base = 1.01 * slack + 64 * UNIT * size, per = 8 * UNIT * size;
    stack[0].low = 0.0;
    stack[0].high = top;
    stack[0].depth = 0;
    for (int i = 0; i <= degree; i++) {
        double sum = 0.0;
        for (int j = 0; j <= i; j++)
            sum += weights[degree][i][j] * terms[j];
        stack[0].b[i] = sum;
    }
    int left = 1, parts = 0;
    while (left > 0) {
        Part part = stack[--left];
        double doubt = base + per * part.depth;
        int changes = 0, sure = 1, above = 1;
        for (int k = 0; k <= degree && sure; k++) {
            if (part.b[k] > doubt) {
                changes += !above;
                above = 1;
            } else if (part.b[k] < -doubt) {
                changes += above;
                above = 0;
            } else
                sure = 0;
        }
        if (sure && changes == 0)
            continue;
        if (sure && changes == 1) {
            *span = sharpened(p, part.low, part.high);
            return MEETS;
        }
        parts++;
        if (part.depth >= DEEPEST || parts > MOST_PARTS) {
            span->low = part.low;
            return UNCLEAR;
        }
        double half = 0.5 * (part.low + part.high);
        Part *right = &stack[left], *first = &stack[left + 1];
        for (int k = 0; k <= degree; k++) {
            first->b[k] = part.b[0];
            right->b[degree - k] = part.b[degree - k];
            for (int m = 0; m < degree - k; m++)
                part.b[m] = (part.b[m] + part.b[m + 1]) * 0.5;
        }
        right->low = half;
        right->high = part.high;
        first->low = part.low;
        first->high = half;
        right->depth = first->depth = part.depth + 1;
        left += 2;
    }
    return NONE;
}

/* A circle that stands, as one that falls meets it: `FloatPeg`. */
typedef struct { double x, y, reach, hx, hy; } Peg;

static int onto_peg(const double *a, const Peg *peg, double until, int stood, Span *span)
{
    double x = a[X], y = a[Y], vx = a[VX], vy = a[VY], t = a[AT], late = a[LATE], hx = peg->hx, hy = peg->hy;
    double end = until - t + (late + 8 * UNIT * (until + t));
    if (end <= 0.0)
        return NONE;
    if (!isfinite(peg->reach)) /* which drops out where they touch as the flight begins */
        return UNCLEAR;
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
    if (stood) {
        p.degree--;
        for (int k = 0; k < DEGREE; k++) {
            p.c[k] = p.c[k + 1];
            p.off[k] = p.off[k + 1];
        }
    }
    int told = falling_zero(&p, end, span);
    if (told != MEETS)
        return told;
    double low = span->low, high = span->high;
    if (!(high - low <= NARROW * high))
        return UNCLEAR;
    span->low = t + low - (late + 8 * UNIT * (t + low));
    span->high = t + high + (late + 8 * UNIT * (t + high));
    return isfinite(span->high) ? MEETS : UNCLEAR;
}

#endif
