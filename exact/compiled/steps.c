/* What `exact/replay/deviations.py` does, compiled: the deviations of midpoints, carried through one contact. The same
 * operations in the same order, on the same lists of an `ErrorSet`, so that both leave the same bits. The bounds are
 * derived in docs/error-bound.md.
 */
#include "rows.h"

/* As in exact/replay: error_bounds.py, deviations.py, contact.py, ball_state.py and centred_state.py: a test
 * holds these against those. */
#define UP (1.0 + 0x1p-40)
#define WIDER (1.0 + 0x1p-39)
#define CARRIED 0x1p-39
#define SMALL_WAIT 0x1p-48
#define MOST 0x1p900
#define MOST_TURN 0x1p100
#define LEAST 1e-280
#define FLAT 0x1p-30
#define STEEPER (1.0 + 0x1p-20)
#define LEAST_TURN 16.0
#define PLAIN 0x1p-100
#define FAINT (-240)
#define ENOUGH (1LL << 40)
#define FEW_BITS 64

enum { X, Y, VX, VY, FLIGHT = COORDINATES + 2 };

static PyObject *name_bounds, *name_place, *name_pace, *name_beside, *name_unit, *name_near, *name_shift, *name_limit,
    *name_grown, *name_hits, *name_pairs, *name_pending, *name_steps, *name_mid,
    *name_accuracy, *name_upper, *none_yet;

/* What a contact needs of an `ErrorSet`; all owned. */
typedef struct {
    PyObject *errors, *bounds, *place, *pace, *pairs, *pending;
    double unit, near;
    Py_ssize_t shift, count;
} Set;

static int open_set(PyObject *errors, Set *set)
{
    *set = (Set){.errors = errors, .bounds = PyObject_GetAttr(errors, name_bounds)};
    if (set->bounds == NULL)
        return -1;
    set->pairs = PyObject_GetAttr(errors, name_pairs);
    set->pending = PyObject_GetAttr(errors, name_pending);
    set->place = PyObject_GetAttr(set->bounds, name_place);
    set->pace = PyObject_GetAttr(set->bounds, name_pace);
    if (set->place == NULL || set->pace == NULL || set->pairs == NULL || set->pending == NULL || get_double(errors, name_unit, &set->unit) < 0
        || get_double(errors, name_near, &set->near) < 0 || get_size(errors, name_shift, &set->shift) < 0)
        return -1;
    if (!PyList_Check(set->place) || !PyList_Check(set->pace) || !PyList_Check(set->pairs) || !PyList_Check(set->pending)
        || PyList_GET_SIZE(set->place) != PyList_GET_SIZE(set->pace)) {
        PyErr_SetString(PyExc_TypeError, "the set keeps lists, those of bounds of one length");
        return -1;
    }
    set->count = PyList_GET_SIZE(set->place) - 1; /* the last is what is fixed */
    return 0;
}

static void close_set(Set *set)
{
    Py_XDECREF(set->bounds);
    Py_XDECREF(set->place);
    Py_XDECREF(set->pace);
    Py_XDECREF(set->pairs);
    Py_XDECREF(set->pending);
}

static int read_bound(const Set *set, Py_ssize_t i, double *place, double *pace)
{
    if (i < 0 || i >= set->count) {
        PyErr_SetString(PyExc_IndexError, "no such body in the set");
        return -1;
    }
    return item_double(set->place, i, place) < 0 || item_double(set->pace, i, pace) < 0 ? -1 : 0;
}

static int put(PyObject *list, Py_ssize_t i, double value)
{
    PyObject *made = PyFloat_FromDouble(value);
    return made == NULL ? -1 : PyList_SetItem(list, i, made);
}

/* How far a body is to fly yet, of what is pending: a tuple's end. */
static int read_legs(const Set *set, Py_ssize_t i, Py_ssize_t count, double *legs)
{
    PyObject *told = item(set->pending, i);
    int failed = told == NULL || read_doubles(told, count, legs) < 0;
    Py_XDECREF(told);
    return failed ? -1 : 0;
}

/* -- balls */

static int upper(PyObject *ball, double *out)
{
    PyObject *bound = PyObject_CallMethodNoArgs(ball, name_upper);
    int failed = bound == NULL || read_double(bound, out) < 0;
    Py_XDECREF(bound);
    return failed ? -1 : 0;
}

static int accuracy(PyObject *ball, long long *least)
{
    PyObject *bits = PyObject_CallMethodNoArgs(ball, name_accuracy);
    if (bits == NULL)
        return -1;
    int overflow;
    long long known = PyLong_AsLongLongAndOverflow(bits, &overflow);
    Py_DECREF(bits);
    if (known == -1 && PyErr_Occurred())
        return -1;
    if (overflow < 0 || known < -ENOUGH) /* flint tells -(2**63 - 1) of a ball around 0, or without end */
        known = -ENOUGH;
    if (overflow <= 0 && known < *least)
        *least = known;
    return 0;
}

/* A body after a contact: its numbers, their middles, and these in doubles. */
typedef struct {
    PyObject *numbers, *mid;
    double in_doubles[COORDINATES];
} Body;

/* `Deviations.recentre`, of one body: adds to the size, lowers the bits, makes the midpoints with `clock` and `last`. */
static int centre(Body *body, PyObject *clock, PyObject *last, double unit, double *size, long long *bits)
{
    if (!PyTuple_Check(body->numbers) || PyTuple_GET_SIZE(body->numbers) != COORDINATES) {
        PyErr_SetString(PyExc_TypeError, "a body has four numbers");
        return -1;
    }
    if (read_doubles(body->numbers, COORDINATES, body->in_doubles) < 0
        || (body->mid = PyTuple_New(COORDINATES + 2)) == NULL)
        return -1;
    for (int k = 0; k < COORDINATES; k++) {
        PyObject *number = PyTuple_GET_ITEM(body->numbers, k);
        PyObject *middle = PyObject_CallMethodNoArgs(number, name_mid);
        if (middle == NULL || accuracy(number, bits) < 0) {
            Py_XDECREF(middle);
            return -1;
        }
        PyTuple_SET_ITEM(body->mid, k, middle);
    }
    PyTuple_SET_ITEM(body->mid, COORDINATES, Py_NewRef(clock));
    PyTuple_SET_ITEM(body->mid, COORDINATES + 1, Py_NewRef(last));
    const double *f = body->in_doubles;
    *size += fabs(f[X]) + fabs(f[Y]) + unit * (fabs(f[VX]) + fabs(f[VY]));
    return 0;
}

static double rounding_of(double size, long long bits, Py_ssize_t shift)
{
    long long power = 2 - bits - (long long)shift;
    if (!(power < 500 && size < 0x1p500))
        return INFINITY;
    return ldexp(size * UP, power > -900 ? (int)power : -900);
}

static long long exponent(double number)
{
    int power;
    frexp(number, &power);
    return power;
}

/* What becomes of one body: `Landing`. */
static PyObject *landing(const Body *body, const Set *set, Py_ssize_t i, double now, double beside, Py_ssize_t least)
{
    double place, pace;
    if (read_bound(set, i, &place, &pace) < 0)
        return NULL;
    long long far = exponent(place) + set->shift, fast = exponent(pace) + set->shift - least;
    const double *f = body->in_doubles;
    int told = far < FAINT && fast < FAINT;
    for (int k = 0; k < COORDINATES; k++)
        told = told && (f[k] > PLAIN || f[k] < -PLAIN);
    PyObject *doubles = NULL;
    if (told) {
        PyObject *numbers[FLIGHT];
        for (int k = 0; k < COORDINATES; k++)
            numbers[k] = PyFloat_FromDouble(f[k]);
        numbers[COORDINATES] = PyFloat_FromDouble(now);
        numbers[COORDINATES + 1] = PyFloat_FromDouble(beside);
        doubles = filled(PyTuple_New(FLIGHT), numbers, FLIGHT);
    } else
        doubles = Py_NewRef(Py_None);
    PyObject *items[] = {Py_NewRef(body->mid), PyLong_FromLongLong(far), PyLong_FromLongLong(fast), doubles};
    return filled(PyTuple_New(4), items, 4);
}

/* What becomes of a contact: `Carried`; False where the deviations are too large. */
static PyObject *land(const Set *set, const Body *bodies, const Py_ssize_t *places, int count, double spread, double late,
                      PyObject *clock, Py_ssize_t least)
{
    double place, pace, last_place, last_pace, now;
    if (read_bound(set, places[0], &place, &pace) < 0 || read_bound(set, places[count - 1], &last_place, &last_pace) < 0
        || read_double(clock, &now) < 0)
        return NULL;
    if (!(spread + (place + pace) + (last_place + last_pace) < MOST))
        Py_RETURN_FALSE;
    long long power = exponent(spread) + set->shift;
    if (power > DBL_MAX_EXP - 1)
        Py_RETURN_FALSE;
    double beside = (late + ldexp(1.0, power > -1000 ? (int)power : -1000)) * UP;
    PyObject *landings[2];
    for (int k = 0; k < count; k++)
        landings[k] = k > 0 && landings[0] == NULL ? NULL : landing(&bodies[k], set, places[k], now, beside, least);
    PyObject *items[] = {
        PyLong_FromLongLong(power), PyFloat_FromDouble(beside), filled(PyTuple_New(count), landings, count)};
    return filled(PyTuple_New(3), items, 3);
}

/* -- `Bounds` and what a set keeps for the end of a block */

static int add_beside(const Set *set, double one, double other)
{
    double beside;
    if (get_double(set->bounds, name_beside, &beside) < 0)
        return -1;
    PyObject *made = PyFloat_FromDouble(beside + one + other);
    int failed = made == NULL || PyObject_SetAttr(set->bounds, name_beside, made) < 0;
    Py_XDECREF(made);
    return failed ? -1 : 0;
}

static int count_step(const Set *set, int grown)
{
    Py_ssize_t steps;
    if (get_size(set->errors, name_steps, &steps) < 0)
        return -1;
    PyObject *more = PyLong_FromSsize_t(steps + 1);
    int failed = more == NULL || PyObject_SetAttr(set->errors, name_steps, more) < 0
        || (grown && PyObject_SetAttr(set->errors, name_grown, Py_True) < 0);
    Py_XDECREF(more);
    return failed ? -1 : 0;
}

/* The derivative of a collision: what `Collision` has. */
typedef struct { double steep, turn, dx, dy, vx, vy, speed, strength, pull; } Collision;

/* `pair_derivative`; 0 where it is not to be had. */
static int derivative(Collision *hit, double unit, double place, double pace, double near)
{
    double square = hit->vx * hit->vx + hit->vy * hit->vy, reach = sqrt(hit->dx * hit->dx + hit->dy * hit->dy);
    double speed = hit->speed;
    if (!(hit->strength < 0.0 && LEAST < speed && speed < INFINITY && LEAST < square && square < INFINITY && reach > 0.0))
        return 0;
    double slow = sqrt(square);
    hit->steep = reach / speed * UP;
    double slant = slow * hit->steep;
    double apart = (1.0 + slant) * place * UP;
    hit->turn = unit * square / speed * UP;
    return slant * (apart / reach + pace / (unit * slow)) * UP < near && hit->turn < MOST_TURN;
}

/* `Deviations._at_once`; 0 where it is None. */
static int at_once(const Collision *hit, double place, double late, double near, double unit, double near_time,
                   double *spread)
{
    double turn = hit->turn > LEAST_TURN ? hit->turn : LEAST_TURN;
    *spread = hit->steep * place * UP;
    return *spread * turn < near * LEAST_TURN * 2.0 * unit && late * turn < LEAST_TURN * near_time;
}

static int keep(const Set *set, const double *parts)
{
    PyObject *hits = PyObject_GetAttr(set->errors, name_hits);
    if (hits == NULL)
        return -1;
    int failed = -1;
    if (!PyByteArray_Check(hits))
        PyErr_SetString(PyExc_TypeError, "the set keeps its hits as bytes");
    else {
        Py_ssize_t size = PyByteArray_GET_SIZE(hits);
        failed = PyByteArray_Resize(hits, size + (Py_ssize_t)sizeof(double) * PARTS);
        if (failed == 0)
            memcpy(PyByteArray_AS_STRING(hits) + size, parts, sizeof(double) * PARTS);
    }
    Py_DECREF(hits);
    return failed;
}

/* `fall_derivative`; 0 where it is not to be had. */
static int fall_derivative(Collision *hit, double unit, double place, double pace, double near)
{
    double size = sqrt(hit->dx * hit->dx + hit->dy * hit->dy), speed = hit->speed, pull = fabs(hit->pull);
    if (!(hit->strength < 0.0 && LEAST < speed && speed < INFINITY && pull < INFINITY))
        return 0;
    hit->steep = size / speed * UP;
    double bend = pull / speed * UP;
    hit->turn = bend * unit * (-hit->strength * size * size / 2.0) * UP;
    return hit->steep * (pace / unit + bend * place) * UP < near && hit->turn < MOST_TURN;
}

/* `ErrorSet.meet`, with `Bounds.meet`, of two that move, or, `movers` being 1, of one and what is fixed. */
static int meet(const Set *set, int movers, const Py_ssize_t *at, const double *lags, const double *weights,
                const Collision *hit, double rounding)
{
    double place[2] = {0.0}, pace[2] = {0.0}, limit, whole = weights[0] + weights[1];
    if (read_bound(set, at[0], &place[0], &pace[0]) < 0
        || (movers > 1 && read_bound(set, at[1], &place[1], &pace[1]) < 0)
        || get_double(set->errors, name_limit, &limit) < 0)
        return -1;
    if (PyList_GET_SIZE(set->pending) != set->count + 1) {
        PyErr_SetString(PyExc_IndexError, "the set's lists differ in length");
        return -1;
    }
    double shares[2] = {2.0 * weights[0] / whole, 2.0 * weights[1] / whole};
    double far[2] = {place[0] + fabs(lags[0]) * pace[0], place[1] + fabs(lags[1]) * pace[1]};
    double both = hit->turn * (far[0] + far[1]), waited = SMALL_WAIT * (pace[0] + pace[1]);
    double least = 0.0, one, two;
    int grown = 0;
    for (int k = 0; k < movers; k++) {
        one = (far[k] + shares[k] * far[1 - k] + waited) * WIDER + rounding;
        two = (pace[k] + shares[k] * (pace[1 - k] + both)) * WIDER + rounding;
        if (k == 0)
            least = one < two ? one : two;
        else {
            least = one < least ? one : least;
            least = two < least ? two : least;
        }
        grown = grown || one > limit || two > limit;
        if (put(set->place, at[k], one) < 0 || put(set->pace, at[k], two) < 0)
            return -1;
    }
    if (add_beside(set, 0.0, CARRIED + rounding / least) < 0 || count_step(set, grown) < 0)
        return -1;
    double parts[PARTS] = {[LEGS] = weights[0], weights[1], hit->dx, hit->dy, hit->vx, hit->vy, hit->speed, hit->strength, hit->pull};
    for (int k = 0; k < 2; k++) {
        double *legs = parts + k * (LEGS / 2);
        Py_ssize_t body = k < movers ? at[k] : set->count; /* what is fixed comes last, and is called -1 */
        if (read_legs(set, body, LEGS / 2, legs) < 0 || append(set->pairs, PyLong_FromSsize_t(k < movers ? body : -1)) < 0
            || PyList_SetItem(set->pending, body, Py_NewRef(none_yet)) < 0)
            return -1;
        legs[LEGS / 2 - 1] = legs[LEGS / 2 - 1] + lags[k];
    }
    return keep(set, parts);
}

/* `ErrorSet.fly`, with `Bounds.fly` and `_then`. A mirror is (xx, xy, yy, off). */
static int fly(const Set *set, Py_ssize_t i, double lag, const double *mirror, double rounding)
{
    double place, pace, limit, legs[5], up = (1.0 + mirror[3]) * UP;
    if (read_bound(set, i, &place, &pace) < 0 || get_double(set->errors, name_limit, &limit) < 0)
        return -1;
    place = (place + fabs(lag) * pace) * up + rounding;
    pace = pace * up + rounding;
    if (put(set->place, i, place) < 0 || put(set->pace, i, pace) < 0
        || add_beside(set, CARRIED + 2.0 * mirror[3], rounding != 0.0 ? rounding / (pace < place ? pace : place) : 0.0) < 0
        || count_step(set, place > limit) < 0 || read_legs(set, i, 5, legs) < 0)
        return -1;
    double a = mirror[0], b = mirror[1], d = mirror[2];
    PyObject *then = Py_BuildValue("(ddddd)", a * legs[0] + b * legs[2], a * legs[1] + b * legs[3],
                                   b * legs[0] + d * legs[2], b * legs[1] + d * legs[3], legs[4] + lag);
    return then == NULL ? -1 : PyList_SetItem(set->pending, i, then);
}

/* -- contacts */

static int given(Py_ssize_t count, Py_ssize_t expected)
{
    if (count == expected)
        return 1;
    PyErr_Format(PyExc_TypeError, "%zd arguments are expected", expected);
    return 0;
}

PyDoc_STRVAR(bounce_doc,
"bounce(errors, i, j, met, since_i, since_j, strength, weights, late, near, one, other, clock, last, least):\n"
"as `carry_pair`; None where the truth may be too far from the midpoints, with nothing changed.");

static PyObject *bounce(PyObject *self, PyObject *const *args, Py_ssize_t count)
{
    if (!given(count, 15))
        return NULL;
    Set set;
    PyObject *told = NULL, *clock = args[12], *last = args[13];
    Py_ssize_t at[2], least;
    double met[5], since[2], weights[2], late, near_time, place[2], pace[2];
    Collision hit = {.pull = 0.0};
    Body bodies[2] = {{args[10], NULL, {0.0}}, {args[11], NULL, {0.0}}};
    if (open_set(args[0], &set) < 0 || read_size(args[1], &at[0]) < 0 || read_size(args[2], &at[1]) < 0
        || read_doubles(args[3], 5, met) < 0 || read_double(args[4], &since[0]) < 0 || read_double(args[5], &since[1]) < 0
        || read_double(args[6], &hit.strength) < 0 || read_doubles(args[7], 2, weights) < 0 || upper(args[8], &late) < 0
        || read_double(args[9], &near_time) < 0 || read_size(args[14], &least) < 0
        || read_bound(&set, at[0], &place[0], &pace[0]) < 0 || read_bound(&set, at[1], &place[1], &pace[1]) < 0)
        goto done;
    late = late * UP;
    double unit = set.unit, near = set.near, lags[2] = {since[0] / unit, since[1] / unit};
    hit.dx = met[0];
    hit.dy = met[1];
    hit.vx = met[2];
    hit.vy = met[3];
    hit.speed = met[4];
    double wide_pace = (pace[0] + pace[1]) * UP;
    double wide = (place[0] + fabs(lags[0]) * pace[0] + place[1] + fabs(lags[1]) * pace[1] + SMALL_WAIT * wide_pace) * UP;
    int known = derivative(&hit, unit, wide, wide_pace, near);
    double spread = 0.0;
    if (!(known && at_once(&hit, wide, late, near, unit, near_time, &spread))) {
        told = Py_NewRef(Py_None);
        goto done;
    }
    double size = 0.0;
    long long bits = ENOUGH;
    for (int k = 0; k < 2; k++)
        if (centre(&bodies[k], clock, last, unit, &size, &bits) < 0)
            goto done;
    if (bits < FEW_BITS) { /* a number near 0, whose radius the two steps take */
        told = Py_NewRef(Py_None);
        goto done;
    }
    if (meet(&set, 2, at, lags, weights, &hit, rounding_of(size, bits, set.shift)) < 0)
        goto done;
    told = land(&set, bodies, at, 2, spread, late, clock, least);
done:
    Py_XDECREF(bodies[0].mid);
    Py_XDECREF(bodies[1].mid);
    close_set(&set);
    return told;
}

PyDoc_STRVAR(rebound_doc,
"rebound(errors, i, since, velocity, face, late, near, one, clock, last, least): as `carry_wall`; None as `bounce`.");

static PyObject *rebound(PyObject *self, PyObject *const *args, Py_ssize_t count)
{
    if (!given(count, 11))
        return NULL;
    Set set;
    PyObject *told = NULL, *clock = args[8], *last = args[9];
    Py_ssize_t i, least;
    double since, velocity[2], normal[2], mirror[4], late, near_time, place, pace;
    Body body = {args[7], NULL, {0.0}};
    if (!PyTuple_Check(args[4]) || PyTuple_GET_SIZE(args[4]) != 3) {
        PyErr_SetString(PyExc_TypeError, "a face is a tuple of three");
        return NULL;
    }
    if (open_set(args[0], &set) < 0 || read_size(args[1], &i) < 0 || read_double(args[2], &since) < 0
        || read_doubles(args[3], 2, velocity) < 0 || read_double(PyTuple_GET_ITEM(args[4], 0), &normal[0]) < 0
        || read_double(PyTuple_GET_ITEM(args[4], 1), &normal[1]) < 0
        || read_doubles(PyTuple_GET_ITEM(args[4], 2), 4, mirror) < 0 || upper(args[5], &late) < 0
        || read_double(args[6], &near_time) < 0 || read_size(args[10], &least) < 0
        || read_bound(&set, i, &place, &pace) < 0)
        goto done;
    late = late * UP;
    double lag = since / set.unit;
    double speed = -(normal[0] * velocity[0] + normal[1] * velocity[1]), width = fabs(normal[0]) + fabs(normal[1]);
    int sharp = speed > FLAT * width * (fabs(velocity[0]) + fabs(velocity[1])) && speed > LEAST;
    double steep = sharp ? width / speed * STEEPER : INFINITY;
    double spread = (place + (fabs(lag) + SMALL_WAIT) * pace) * UP * (steep * UP);
    if (!(spread < set.near * set.unit && late < near_time)) {
        told = Py_NewRef(Py_None);
        goto done;
    }
    double size = 0.0;
    long long bits = ENOUGH;
    if (centre(&body, clock, last, set.unit, &size, &bits) < 0)
        goto done;
    if (bits < FEW_BITS) {
        told = Py_NewRef(Py_None);
        goto done;
    }
    if (fly(&set, i, lag, mirror, rounding_of(size, bits, set.shift)) < 0)
        goto done;
    told = land(&set, &body, &i, 1, spread, late, clock, least);
done:
    Py_XDECREF(body.mid);
    close_set(&set);
    return told;
}

PyDoc_STRVAR(fall_doc,
"fall(errors, i, since, speed, slope, late, near, one, clock, last, least): as `carry_fall`; None as `bounce`. The speed is\n"
"a double, not a number where that does not tell it.");

static PyObject *fall(PyObject *self, PyObject *const *args, Py_ssize_t count)
{
    if (!given(count, 11))
        return NULL;
    Set set;
    PyObject *told = NULL, *clock = args[8], *last = args[9];
    Py_ssize_t i, least;
    double since, slope[4], late, near_time, place, pace;
    Collision hit = {.vx = 0.0, .vy = 0.0};
    Body body = {args[7], NULL, {0.0}};
    if (open_set(args[0], &set) < 0 || read_size(args[1], &i) < 0 || read_double(args[2], &since) < 0
        || read_double(args[3], &hit.speed) < 0 || read_doubles(args[4], 4, slope) < 0 || upper(args[5], &late) < 0
        || read_double(args[6], &near_time) < 0 || read_size(args[10], &least) < 0
        || read_bound(&set, i, &place, &pace) < 0)
        goto done;
    late = late * UP;
    hit.dx = slope[0];
    hit.dy = slope[1];
    hit.strength = slope[2];
    hit.pull = slope[3];
    double lags[2] = {since / set.unit, 0.0}, spread = 0.0;
    const double weights[2] = {1.0, 0.0};
    double wide = (place + (fabs(lags[0]) + SMALL_WAIT) * pace) * UP;
    if (!(fall_derivative(&hit, set.unit, wide, pace, set.near)
          && at_once(&hit, wide, late, set.near, set.unit, near_time, &spread))) {
        told = Py_NewRef(Py_None);
        goto done;
    }
    double size = 0.0;
    long long bits = ENOUGH;
    if (centre(&body, clock, last, set.unit, &size, &bits) < 0)
        goto done;
    if (bits < FEW_BITS) {
        told = Py_NewRef(Py_None);
        goto done;
    }
    if (meet(&set, 1, &i, lags, weights, &hit, rounding_of(size, bits, set.shift)) < 0)
        goto done;
    told = land(&set, &body, &i, 1, spread, late, clock, least);
done:
    Py_XDECREF(body.mid);
    close_set(&set);
    return told;
}

/* -- the end of a block */

/* A contiguous array of doubles, of so many at least, writable or not. */
static int view(PyObject *array, int writable, Py_ssize_t least, Py_buffer *out)
{
    if (PyObject_GetBuffer(array, out, PyBUF_C_CONTIGUOUS | PyBUF_FORMAT | (writable ? PyBUF_WRITABLE : 0)) < 0)
        return -1;
    if (out->itemsize == sizeof(double) && out->format != NULL && out->format[0] == 'd'
        && out->len >= least * (Py_ssize_t)sizeof(double))
        return 0;
    PyBuffer_Release(out);
    PyErr_SetString(PyExc_TypeError, "an array of enough doubles is expected");
    return -1;
}

PyDoc_STRVAR(carry_doc,
"carry(rows, pairs, hits, blocks, pending): takes rows of fours, a body's after another's, through collisions in order,\n"
"of the bodies that `pairs` names after one another, and each body's through what it flew after them.");

static PyObject *carry(PyObject *self, PyObject *const *args, Py_ssize_t count)
{
    if (!given(count, 5))
        return NULL;
    if (!PyList_Check(args[1]) || !PyList_Check(args[4])) {
        PyErr_SetString(PyExc_TypeError, "pairs and what is pending are lists");
        return NULL;
    }
    Py_buffer views[3];
    Py_ssize_t collisions = PyList_GET_SIZE(args[1]) / 2;
    const Py_ssize_t least[3] = {0, collisions * PARTS, collisions * BLOCKS};
    PyObject *const arrays[3] = {args[0], args[2], args[3]};
    int held = 0;
    PyObject *done = NULL;
    for (; held < 3; held++)
        if (view(arrays[held], held == 0, least[held], &views[held]) < 0)
            goto end;
    if (views[0].ndim != 3 || views[0].shape[1] != COORDINATES) {
        PyErr_SetString(PyExc_TypeError, "rows of fours are expected");
        goto end;
    }
    Rows rows = {views[0].buf, NULL, views[0].shape[0], views[0].shape[2]};
    rows.scratch = PyMem_New(double, BOTH * rows.width);
    if (rows.scratch == NULL)
        PyErr_NoMemory();
    else if (carry_rows(&rows, args[1], views[1].buf, views[2].buf, args[4]) == 0)
        done = Py_NewRef(Py_None);
    PyMem_Free(rows.scratch);
end:
    while (held > 0)
        PyBuffer_Release(&views[--held]);
    return done;
}

PyDoc_STRVAR(constants_doc, "constants(): the numbers of Python that are written here again, by name.");

static PyObject *constants(PyObject *self, PyObject *nothing)
{
    return Py_BuildValue("{sdsdsdsdsdsdsdsdsdsdsdsisL}", "UP", UP, "WIDER", WIDER, "CARRIED", CARRIED, "SMALL_WAIT",
                         SMALL_WAIT, "MOST", MOST, "MOST_TURN", MOST_TURN, "LEAST", LEAST, "FLAT", FLAT, "STEEPER",
                         STEEPER, "LEAST_TURN", LEAST_TURN, "PLAIN", PLAIN, "FAINT", FAINT, "ENOUGH", ENOUGH,
                         "FEW_BITS", FEW_BITS);
}

static PyMethodDef methods[] = {
    {"bounce", (PyCFunction)(void (*)(void))bounce, METH_FASTCALL, bounce_doc},
    {"rebound", (PyCFunction)(void (*)(void))rebound, METH_FASTCALL, rebound_doc},
    {"fall", (PyCFunction)(void (*)(void))fall, METH_FASTCALL, fall_doc},
    {"carry", (PyCFunction)(void (*)(void))carry, METH_FASTCALL, carry_doc},
    {"constants", constants, METH_NOARGS, constants_doc},
    {NULL, NULL, 0, NULL},
};

static struct PyModuleDef module = {
    PyModuleDef_HEAD_INIT, "_steps", "Contacts of midpoints with a set of deviations, compiled.", -1, methods,
    NULL, NULL, NULL, NULL,
};

PyMODINIT_FUNC PyInit__steps(void)
{
    const Name names[] = {
        {&name_bounds, "bounds"}, {&name_place, "place"}, {&name_pace, "pace"}, {&name_beside, "beside"},
        {&name_unit, "_unit"}, {&name_near, "near"}, {&name_shift, "shift"}, {&name_limit, "_limit"},
        {&name_grown, "_grown"}, {&name_hits, "_hits"}, {&name_pairs, "_pairs"}, {&name_pending, "_pending"}, {&name_steps, "_steps"}, {&name_mid, "mid"},
        {&name_accuracy, "rel_accuracy_bits"}, {&name_upper, "abs_upper"}, {NULL, NULL}};
    none_yet = Py_BuildValue("(ddddd)", 1.0, 0.0, 0.0, 1.0, 0.0); /* `STILL` */
    return none_yet == NULL || intern(names) < 0 ? NULL : PyModule_Create(&module);
}
