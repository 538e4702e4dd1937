/* What `filtered.py`, `FilteredPredictor.predict` and `ArrivalQueue` do in doubles, compiled: the same operations
 * in the same order, so that both give the same bits. The bounds are derived in filtered.py; nothing is decided
 * here that is not decided there. Built where there is a compiler; without it, the Python runs.
 *
 * No operation may be fused or kept wider than a double: see pyproject.toml for the compiler's options.
 */
#include "quartic.h"
#include <structmember.h>

#define PLAIN 7 /* of an arrival: low, order, high, two circles, or a circle and ~k for wall k, and their serial numbers */

#define MOST_MOVED 2
#define MOST_CIRCLES 256
#define MOST_WALLS 256
#define MOST_PEGS 256
#define MOST_STANDING 8

static PyObject *heappush, *heappop, *infinity;

/* -- reading Python's objects */

/* What is read of a body, and where the slots of the classes that it may be of have it: an attribute takes longer to be
 * found than most circles take to be held against another. */
enum { IS_F, IS_KIND, IS_INDEX, IS_SERIAL, IS_UNTIL, READ };

static PyObject *names_of[READ];

static struct { PyTypeObject *type; Py_ssize_t at[READ]; } layouts[2];

/* Notes where a class has its slots; 0 for what is none. */
static int learn(PyTypeObject *type, Py_ssize_t *at)
{
    for (int k = 0; k < READ; k++) {
        PyObject *slot = PyObject_GetAttr((PyObject *)type, names_of[k]);
        if (slot == NULL)
            return -1;
        int found = Py_IS_TYPE(slot, &PyMemberDescr_Type) && PyType_IsSubtype(type, PyDescr_TYPE(slot))
                    && ((PyMemberDescrObject *)slot)->d_member->type == T_OBJECT_EX;
        at[k] = found ? ((PyMemberDescrObject *)slot)->d_member->offset : 0;
        Py_DECREF(slot);
    }
    return 0;
}

/* One of these of a body, owned; NULL with an error set. */
static PyObject *get(PyObject *body, int which)
{
    PyTypeObject *type = Py_TYPE(body);
    for (int k = 0; k < 2; k++) {
        if (layouts[k].type == NULL) {
            if (learn(type, layouts[k].at) < 0)
                PyErr_Clear();
            else
                layouts[k].type = (PyTypeObject *)Py_NewRef(type);
        }
        if (layouts[k].type == type && layouts[k].at[which] != 0) {
            PyObject *value = *(PyObject **)((char *)body + layouts[k].at[which]);
            if (value != NULL)
                return Py_NewRef(value);
        }
    }
    return PyObject_GetAttr(body, names_of[which]);
}

static int get_number(PyObject *body, int which, Py_ssize_t *out)
{
    PyObject *value = get(body, which);
    int failed = value == NULL || read_size(value, out) < 0;
    Py_XDECREF(value);
    return failed ? -1 : 0;
}

/* The doubles of a body; 0 if it has none, -1 with an error set. */
static int read_flight(PyObject *body, double *out)
{
    PyObject *f = get(body, IS_F);
    if (f == NULL)
        return -1;
    int found = f == Py_None ? 0 : read_doubles(f, FLIGHT, out) < 0 ? -1 : 1;
    Py_DECREF(f);
    return found;
}

static int read_reach(PyObject *reaches, PyObject *body, double *out)
{
    Py_ssize_t kind;
    if (get_number(body, IS_KIND, &kind) < 0)
        return -1;
    return item_double(reaches, kind, out);
}

static int read_bounds(PyObject *tuple, Bounds *bounds)
{
    double five[5];
    if (read_doubles(tuple, 5, five) < 0)
        return -1;
    *bounds = (Bounds){five[0], five[1], five[2], five[3], five[4]};
    return 0;
}

/* Holds a circle in doubles against one other: which of the above, FAILED with an error set. */
static int hold(const double *a, PyObject *other, PyObject *reaches, const Bounds *bounds, Against *held, Span *span)
{
    double b[FLIGHT], reach;
    int known = read_flight(other, b);
    if (known <= 0)
        return known < 0 ? FAILED : UNCLEAR;
    Apart apart;
    if (!near(a, b, bounds, held, &apart))
        return NONE;
    if (read_reach(reaches, other, &reach) < 0)
        return FAILED;
    return pair(&apart, reach, bounds, held->late, span);
}

/* -- one circle: `DoubleFilter.pairs` and `DoubleFilter.walls` */

static PyObject *both_lists(PyObject *found, PyObject *unclear)
{
    return Py_BuildValue("(NN)", found, unclear);
}

PyDoc_STRVAR(pairs_doc, "pairs(f, others, reaches, bounds): as `DoubleFilter.pairs`, of a flight in doubles.");

static PyObject *pairs(PyObject *self, PyObject *const *args, Py_ssize_t count)
{
    double a[FLIGHT];
    Bounds bounds;
    if (count != 4) {
        PyErr_SetString(PyExc_TypeError, "pairs: four arguments");
        return NULL;
    }
    PyObject *others = PySequence_Fast(args[1], "pairs: others");
    if (others == NULL || read_doubles(args[0], FLIGHT, a) < 0 || read_bounds(args[3], &bounds) < 0) {
        Py_XDECREF(others);
        return NULL;
    }
    PyObject *found = PyList_New(0), *unclear = PyList_New(0);
    if (found == NULL || unclear == NULL)
        goto failed;
    Against held = against(a, &bounds);
    for (Py_ssize_t k = 0; k < PySequence_Fast_GET_SIZE(others); k++) {
        PyObject *b = Py_NewRef(PySequence_Fast_GET_ITEM(others, k));
        Span span;
        int told = hold(a, b, args[2], &bounds, &held, &span);
        if ((told == MEETS && append(found, Py_BuildValue("(ddO)", span.low, span.high, b)) < 0)
            || (told == UNCLEAR && PyList_Append(unclear, b) < 0))
            told = FAILED;
        Py_DECREF(b);
        if (told == FAILED)
            goto failed;
    }
    Py_DECREF(others);
    return both_lists(found, unclear);
failed:
    Py_DECREF(others);
    Py_XDECREF(found);
    Py_XDECREF(unclear);
    return NULL;
}

static int read_line(PyObject *line, long *number, double *out)
{
    if (!PyTuple_Check(line) || PyTuple_GET_SIZE(line) != 8) {
        PyErr_SetString(PyExc_TypeError, "a line is a tuple of eight");
        return -1;
    }
    *number = PyLong_AsLong(PyTuple_GET_ITEM(line, 0));
    return (*number == -1 && PyErr_Occurred()) || read_doubles(line, 7, out) < 0 ? -1 : 0;
}

enum { FALLS = 13 }; /* of a `FloatFall`: which, the other side, whether it is a face, and ten doubles */

/* A `FloatFall`: 1 if it is one, 0 if it is a line that stands, -1 with an error set. */
static int read_falls(PyObject *line, long *number, long *other, Falls *out)
{
    double ten[10];
    if (!PyTuple_Check(line) || PyTuple_GET_SIZE(line) != FALLS)
        return 0;
    *number = PyLong_AsLong(PyTuple_GET_ITEM(line, 0));
    *other = PyLong_AsLong(PyTuple_GET_ITEM(line, 1));
    int is_face = PyObject_IsTrue(PyTuple_GET_ITEM(line, 2));
    if (PyErr_Occurred() || is_face < 0 || read_doubles(line, 10, ten) < 0)
        return -1;
    *out = (Falls){ten[0], ten[1], ten[2], ten[3], ten[4], ten[5], ten[6], ten[7], ten[8], ten[9], is_face};
    return 1;
}

typedef int (*Meets)(const double *a, const double *line, double flat, double far, Span *span);

/* Which of some lines a circle meets, each as `meets` tells. */
static PyObject *meet_lines(Meets meets, PyObject *const *args, Py_ssize_t count)
{
    double a[FLIGHT], flat, far;
    if (count != 4) {
        PyErr_SetString(PyExc_TypeError, "a flight, lines, and two bounds are expected");
        return NULL;
    }
    if (read_double(args[2], &flat) < 0 || read_double(args[3], &far) < 0 || read_doubles(args[0], FLIGHT, a) < 0)
        return NULL;
    PyObject *lines = PySequence_Fast(args[1], "lines are expected");
    if (lines == NULL)
        return NULL;
    PyObject *found = PyList_New(0), *unclear = PyList_New(0);
    if (found == NULL || unclear == NULL)
        goto failed;
    for (Py_ssize_t k = 0; k < PySequence_Fast_GET_SIZE(lines); k++) {
        double line[7];
        long number;
        Span span;
        PyObject *told_line = Py_NewRef(PySequence_Fast_GET_ITEM(lines, k));
        int failed = read_line(told_line, &number, line) < 0;
        Py_DECREF(told_line);
        if (failed)
            goto failed;
        int told = meets(a, line, flat, far, &span);
        if (told == MEETS && append(found, Py_BuildValue("(ddl)", span.low, span.high, number)) < 0)
            goto failed;
        if (told == UNCLEAR && append(unclear, PyLong_FromLong(number)) < 0)
            goto failed;
    }
    Py_DECREF(lines);
    return both_lists(found, unclear);
failed:
    Py_DECREF(lines);
    Py_XDECREF(found);
    Py_XDECREF(unclear);
    return NULL;
}

PyDoc_STRVAR(walls_doc, "walls(f, lines, flat, far): as `DoubleFilter.walls`, of a flight in doubles.");

static PyObject *walls(PyObject *self, PyObject *const *args, Py_ssize_t count)
{
    return meet_lines(wall, args, count);
}

PyDoc_STRVAR(faces_doc, "faces(f, lines, flat, far): as `DoubleFilter.faces`, of a flight in doubles.");

static PyObject *faces(PyObject *self, PyObject *const *args, Py_ssize_t count)
{
    return meet_lines(face, args, count);
}

/* -- zeros of quartics: `falling_zero`, `peg_in_doubles` and `side_in_doubles` */

static int read_poly(PyObject *numbers, double *out)
{
    PyObject *all = PySequence_Fast(numbers, "numbers are expected");
    if (all == NULL)
        return -1;
    int count = (int)PySequence_Fast_GET_SIZE(all), failed = count < 1 || count > TERMS;
    if (failed)
        PyErr_SetString(PyExc_TypeError, "one to five coefficients are expected");
    for (int k = 0; !failed && k < count; k++)
        failed = read_double(PySequence_Fast_GET_ITEM(all, k), &out[k]) < 0;
    Py_DECREF(all);
    return failed ? -1 : count;
}

PyDoc_STRVAR(falling_zero_doc, "falling_zero(c, off, end): as `falling_zero` of round_falls.py.");

static PyObject *first_fall(PyObject *self, PyObject *const *args, Py_ssize_t count)
{
    Poly p;
    double end;
    Span span;
    if (count != 3) {
        PyErr_SetString(PyExc_TypeError, "falling_zero: coefficients, their errors, and an end");
        return NULL;
    }
    int terms = read_poly(args[0], p.c), bounds = terms < 0 ? -1 : read_poly(args[1], p.off);
    if (bounds < 0 || read_double(args[2], &end) < 0)
        return NULL;
    if (bounds != terms) {
        PyErr_SetString(PyExc_TypeError, "falling_zero: a bound for each coefficient is expected");
        return NULL;
    }
    p.degree = terms - 1;
    int told = falling_zero(&p, end, &span);
    if (told == MEETS)
        return Py_BuildValue("(dd)", span.low, span.high);
    return told == UNCLEAR ? PyFloat_FromDouble(span.low) : Py_NewRef(Py_None);
}

enum { PEG = 6 }; /* of a `FloatPeg`: a body, and five doubles */

static int read_peg(PyObject *peg, Peg *out)
{
    double five[5];
    if (!PyTuple_Check(peg) || PyTuple_GET_SIZE(peg) != PEG) {
        PyErr_SetString(PyExc_TypeError, "a circle that stands is a tuple of six");
        return -1;
    }
    if (read_doubles(peg, 5, five) < 0)
        return -1;
    *out = (Peg){five[0], five[1], five[2], five[3], five[4]};
    return 0;
}

PyDoc_STRVAR(onto_peg_doc, "onto_peg(f, peg, until, stood): as `peg_in_doubles`.");

static PyObject *peg_met(PyObject *self, PyObject *const *args, Py_ssize_t count)
{
    double a[FLIGHT], until;
    Peg peg;
    Span span;
    if (count != 4) {
        PyErr_SetString(PyExc_TypeError, "onto_peg: four arguments");
        return NULL;
    }
    int stood = PyObject_IsTrue(args[3]);
    if (stood < 0 || read_doubles(args[0], FLIGHT, a) < 0 || read_peg(args[1], &peg) < 0 || read_double(args[2], &until) < 0)
        return NULL;
    int told = onto_peg(a, &peg, until, stood, &span);
    return told == MEETS ? Py_BuildValue("(dd)", span.low, span.high) : PyBool_FromLong(told == UNCLEAR);
}

enum { SIDE = 11 }; /* of a `FallenSide`: which, whether it is full, and nine doubles */

PyDoc_STRVAR(onto_side_doc, "onto_side(f, side, until, stood): as `side_in_doubles`.");

static PyObject *side_met(PyObject *self, PyObject *const *args, Py_ssize_t count)
{
    double a[FLIGHT], until, nine[9];
    Span span;
    if (count != 4 || !PyTuple_Check(args[1]) || PyTuple_GET_SIZE(args[1]) != SIDE) {
        PyErr_SetString(PyExc_TypeError, "onto_side: a flight, a side of eleven, a time, and whether they touch");
        return NULL;
    }
    int full = PyObject_IsTrue(PyTuple_GET_ITEM(args[1], 1)), stood = PyObject_IsTrue(args[3]);
    if (full < 0 || stood < 0 || read_doubles(args[0], FLIGHT, a) < 0 || read_doubles(args[1], 9, nine) < 0
        || read_double(args[2], &until) < 0)
        return NULL;
    Side side = {{nine[0], nine[1], nine[2], nine[3], nine[4]}, nine[5], nine[6], nine[7], nine[8], full};
    int told = onto_side(a, &side, until, stood, &span);
    return told == MEETS ? Py_BuildValue("(dd)", span.low, span.high) : PyBool_FromLong(told == UNCLEAR);
}

/* Whether a number is in a tuple: 1, 0, or -1 with an error set. */
static int is_among(PyObject *numbers, long number)
{
    for (Py_ssize_t k = 0; k < PyTuple_GET_SIZE(numbers); k++) {
        long each = PyLong_AsLong(PyTuple_GET_ITEM(numbers, k));
        if (each == -1 && PyErr_Occurred())
            return -1;
        if (each == number)
            return 1;
    }
    return 0;
}

PyDoc_STRVAR(falls_doc, "falls(f, lines, flat, far, stands): as `falls_in_doubles`.");

static PyObject *falls(PyObject *self, PyObject *const *args, Py_ssize_t count)
{
    double a[FLIGHT], flat, far;
    if (count != 5 || !PyTuple_Check(args[4])) {
        PyErr_SetString(PyExc_TypeError, "falls: a flight, lines, two bounds, and a tuple");
        return NULL;
    }
    if (read_double(args[2], &flat) < 0 || read_double(args[3], &far) < 0 || read_doubles(args[0], FLIGHT, a) < 0)
        return NULL;
    PyObject *lines = PySequence_Fast(args[1], "lines are expected");
    if (lines == NULL)
        return NULL;
    PyObject *found = PyList_New(0), *unclear = PyList_New(0);
    if (found == NULL || unclear == NULL)
        goto failed;
    for (Py_ssize_t k = 0; k < PySequence_Fast_GET_SIZE(lines); k++) {
        Falls line;
        Span span;
        long number, other;
        int known = read_falls(PySequence_Fast_GET_ITEM(lines, k), &number, &other, &line);
        if (known == 0)
            PyErr_SetString(PyExc_TypeError, "what falls is a tuple of thirteen");
        if (known <= 0)
            goto failed;
        int beside = is_among(args[4], other), stands_there = is_among(args[4], number);
        if (beside < 0 || stands_there < 0)
            goto failed;
        int told = beside ? NONE : fall(a, &line, flat, far, stands_there, &span);
        if (told == MEETS && append(found, Py_BuildValue("(ddl)", span.low, span.high, number)) < 0)
            goto failed;
        if (told == UNCLEAR && append(unclear, PyLong_FromLong(number)) < 0)
            goto failed;
    }
    Py_DECREF(lines);
    return both_lists(found, unclear);
failed:
    Py_DECREF(lines);
    Py_XDECREF(found);
    Py_XDECREF(unclear);
    return NULL;
}

/* -- all meetings of one or two circles, queued: `FilteredPredictor.predict` where doubles tell all */

typedef struct { Py_ssize_t a, b; int is_wall; } Standing;

/* A circle whose flight is new. */
typedef struct {
    PyObject *body, *others, *lines, *reaches, *pegs; /* owned */
    double f[FLIGHT], until;
    Py_ssize_t index, serial;
} Moved;

/* An arrival: at a wall (~k), or another circle. */
typedef struct {
    Span span;
    Py_ssize_t i, j, si, sj;
    int falls; /* a wall that falls, where a contact that stands is none to leave out: see `fall` */
} Entry;

/* Whether a contact is with something of a kind. */
static int is_named(PyObject *link, const char *kind)
{
    return PyTuple_GET_SIZE(link) == 3 && PyUnicode_Check(PyTuple_GET_ITEM(link, 2))
        && PyUnicode_CompareWithASCIIString(PyTuple_GET_ITEM(link, 2), kind) == 0;
}

/* 1 if told, 0 if this is left to Python, -1 with an error set. */
static int read_standing(PyObject *tuple, Standing *out, int *count)
{
    if (!PyTuple_Check(tuple) || PyTuple_GET_SIZE(tuple) > MOST_STANDING)
        return 0;
    *count = 0;
    for (Py_ssize_t n = 0; n < PyTuple_GET_SIZE(tuple); n++) {
        PyObject *link = PyTuple_GET_ITEM(tuple, n);
        if (!PyTuple_Check(link))
            return 0;
        Py_ssize_t size = PyTuple_GET_SIZE(link);
        int is_wall = is_named(link, "wall"), k = *count;
        if (is_named(link, "arc")) /* is looked at apart from all these: see `PegPredictor` */
            continue;
        if (size != 2 && !is_wall)
            return 0;
        ++*count;
        out[k].is_wall = is_wall;
        if (read_size(PyTuple_GET_ITEM(link, 0), &out[k].a) < 0 || read_size(PyTuple_GET_ITEM(link, 1), &out[k].b) < 0)
            return -1;
    }
    return 1;
}

static int stands(const Standing *standing, int count, Py_ssize_t a, Py_ssize_t b, int is_wall)
{
    for (int k = 0; k < count; k++)
        if (standing[k].is_wall == is_wall
            && ((standing[k].a == a && standing[k].b == b) || (!is_wall && standing[k].a == b && standing[k].b == a)))
            return 1;
    return 0;
}

static int push(PyObject *heap, const Entry *entry, Py_ssize_t order)
{
    PyObject *items[] = {PyFloat_FromDouble(entry->span.low), PyLong_FromSsize_t(order),
                         PyFloat_FromDouble(entry->span.high), PyLong_FromSsize_t(entry->i),
                         PyLong_FromSsize_t(entry->j), PyLong_FromSsize_t(entry->si), PyLong_FromSsize_t(entry->sj)};
    PyObject *made = filled(PyTuple_New(PLAIN), items, PLAIN);
    if (made == NULL)
        return -1;
    PyObject *both[] = {heap, made}, *done = PyObject_Vectorcall(heappush, both, 2, NULL);
    Py_DECREF(made);
    Py_XDECREF(done);
    return done == NULL ? -1 : 0;
}

/* By low, then high, then wall, as Python sorts tuples. */
static int is_later(const Entry *one, const Entry *other)
{
    if (one->span.low != other->span.low)
        return one->span.low > other->span.low;
    if (one->span.high != other->span.high)
        return one->span.high > other->span.high;
    return ~one->j > ~other->j;
}

/* Appends the walls and faces that end a flight, and when they do, to the entries; as `read_standing`. */
static int meet_walls(Moved *a, PyObject *lines, double flat, double far, Py_ssize_t first_face,
                      const Standing *standing, int standing_count, Entry *entries, int *count)
{
    Entry found[MOST_WALLS];
    int many = 0;
    if (!PyList_Check(lines) || PyList_GET_SIZE(lines) > MOST_WALLS)
        return 0;
    for (Py_ssize_t k = 0, size = PyList_GET_SIZE(lines); k < size; k++) {
        double line[7];
        long number, other;
        Falls falling;
        Entry entry = {{0.0, 0.0}, a->index, 0, a->serial, 0, 0};
        PyObject *told_line = item(lines, k);
        int known = told_line == NULL ? -1 : read_falls(told_line, &number, &other, &falling);
        if (known == 0)
            known = read_line(told_line, &number, line);
        entry.falls = known > 0;
        Py_XDECREF(told_line);
        if (known < 0)
            return -1;
        int told;
        if (!entry.falls)
            told = (number < first_face ? wall : face)(a->f, line, flat, far, &entry.span);
        else if (other >= 0 && stands(standing, standing_count, a->index, other, 1))
            continue;
        else
            told = fall(a->f, &falling, flat, far, stands(standing, standing_count, a->index, number, 1), &entry.span);
        if (told == UNCLEAR)
            return 0;
        if (told == NONE)
            continue;
        entry.j = ~(Py_ssize_t)number;
        int at = many++;
        for (; at > 0 && is_later(&found[at - 1], &entry); at--)
            found[at] = found[at - 1];
        found[at] = entry;
    }
    for (int k = 0; k < many && found[k].span.low <= a->until; k++) {
        if (!found[k].falls && stands(standing, standing_count, a->index, ~found[k].j, 1))
            continue;
        if (found[k].span.high < a->until)
            a->until = found[k].span.high;
        entries[(*count)++] = found[k];
    }
    return 1;
}

/* Puts two circles, in order, into an entry. */
static void name_both(Entry *entry, Py_ssize_t i, Py_ssize_t si, Py_ssize_t j, Py_ssize_t sj)
{
    entry->i = i < j ? i : j;
    entry->j = i < j ? j : i;
    entry->si = i < j ? si : sj;
    entry->sj = i < j ? sj : si;
}

/* Appends the circles that stand which end a flight, and when they do, to the entries; as `read_standing`. */
static int meet_pegs(Moved *a, const Standing *standing, int standing_count, Entry *entries, int *count)
{
    if (!PyList_Check(a->pegs) || PyList_GET_SIZE(a->pegs) > MOST_PEGS)
        return 0;
    for (Py_ssize_t k = 0; k < PyList_GET_SIZE(a->pegs); k++) {
        Peg peg;
        Py_ssize_t index, serial;
        PyObject *told_peg = item(a->pegs, k);
        int failed = told_peg == NULL || read_peg(told_peg, &peg) < 0;
        PyObject *body = failed ? NULL : PyTuple_GET_ITEM(told_peg, 0);
        failed = failed || get_number(body, IS_INDEX, &index) < 0 || get_number(body, IS_SERIAL, &serial) < 0;
        Py_XDECREF(told_peg);
        if (failed)
            return -1;
        Entry *entry = &entries[*count];
        int stood = stands(standing, standing_count, a->index, index, 0);
        int told = onto_peg(a->f, &peg, a->until, stood, &entry->span);
        if (told == UNCLEAR)
            return 0;
        if (told == NONE || entry->span.low > a->until)
            continue;
        name_both(entry, a->index, a->serial, index, serial);
        if (entry->span.high < a->until)
            a->until = entry->span.high;
        ++*count;
    }
    return 1;
}

/* A circle that another may meet before a wall ends a flight: whether it does, as for `hold`. */
static int meet_circle(const Moved *a, const Moved *moved, Py_ssize_t moved_count, PyObject *b, PyObject *reaches,
                       const Bounds *bounds, Against *held, Entry *entry)
{
    int told = hold(a->f, b, reaches, bounds, held, &entry->span), is_new = 0;
    double until = 0.0;
    Py_ssize_t index, serial;
    if (told != MEETS || entry->span.low > a->until)
        return told == MEETS ? NONE : told;
    for (Py_ssize_t m = 0; m < moved_count; m++)
        if (moved[m].body == b) {
            is_new = 1;
            until = moved[m].until;
        }
    PyObject *ends = is_new ? NULL : get(b, IS_UNTIL);
    int failed = !is_new && (ends == NULL || read_double(ends, &until) < 0);
    Py_XDECREF(ends);
    if (failed)
        return FAILED;
    if (entry->span.low > until)
        return NONE;
    if (get_number(b, IS_INDEX, &index) < 0 || get_number(b, IS_SERIAL, &serial) < 0)
        return FAILED;
    name_both(entry, a->index, a->serial, index, serial);
    return MEETS;
}

/* Appends the circles that one may meet before a wall ends a flight; as `read_standing`. */
static int meet_circles(const Moved *a, const Moved *moved, Py_ssize_t moved_count, PyObject *others,
                        PyObject *reaches, const Bounds *bounds, const Standing *standing, int standing_count,
                        Entry *entries, int *count)
{
    if (!PyList_Check(others) || PyList_GET_SIZE(others) > MOST_CIRCLES)
        return 0;
    Against held = against(a->f, bounds);
    for (Py_ssize_t k = 0, size = PyList_GET_SIZE(others); k < size; k++) {
        PyObject *b = item(others, k);
        Entry entry;
        int told = b == NULL ? FAILED : meet_circle(a, moved, moved_count, b, reaches, bounds, &held, &entry);
        Py_XDECREF(b);
        if (told == FAILED)
            return -1;
        if (told == UNCLEAR)
            return 0;
        if (told == MEETS && !stands(standing, standing_count, entry.i, entry.j, 0))
            entries[(*count)++] = entry;
    }
    return 1;
}

/* Takes up a circle with what it may meet; as `read_standing`. */
static int take(Moved *a, PyObject *bodies, PyObject *others, PyObject *lines, PyObject *reaches, PyObject *pegs, Py_ssize_t k)
{
    a->body = PySequence_GetItem(bodies, k);
    a->others = item(others, k);
    a->lines = item(lines, k);
    a->reaches = item(reaches, k);
    a->pegs = item(pegs, k);
    a->until = INFINITY;
    if (a->body == NULL || a->others == NULL || a->lines == NULL || a->reaches == NULL || a->pegs == NULL)
        return -1;
    int told = read_flight(a->body, a->f);
    if (told <= 0 || (a->f[VX] == 0.0 && a->f[VY] == 0.0))
        return told < 0 ? -1 : 0;
    return get_number(a->body, IS_INDEX, &a->index) < 0 || get_number(a->body, IS_SERIAL, &a->serial) < 0 ? -1 : 1;
}

static int set_until(const Moved *a)
{
    PyObject *until = a->until == INFINITY ? Py_NewRef(infinity) : PyFloat_FromDouble(a->until);
    int failed = until == NULL || PyObject_SetAttr(a->body, names_of[IS_UNTIL], until) < 0;
    Py_XDECREF(until);
    return failed ? -1 : 0;
}

PyDoc_STRVAR(predict_doc,
"predict(moved, others, lines, reaches, pegs, bounds, slopes, standing, heap, order, first_face): queues the next meetings of\n"
"one or two circles, each with its others and its walls, of which those from `first_face` on are faces, and sets when\n"
"these end their flights. Gives the last order used; None, with nothing changed, where doubles leave something open or\n"
"this is not the ordinary case.");

static PyObject *predict(PyObject *self, PyObject *const *args, Py_ssize_t count)
{
    if (count != 11) {
        PyErr_SetString(PyExc_TypeError, "predict: eleven arguments");
        return NULL;
    }
    PyObject *bodies = args[0], *others = args[1], *lines = args[2], *reaches = args[3], *pegs = args[4], *heap = args[8];
    Bounds bounds;
    double slopes[2];
    Standing standing[MOST_STANDING];
    Moved moved[MOST_MOVED] = {{0}};
    Entry entries[MOST_MOVED * (MOST_CIRCLES + MOST_WALLS + MOST_PEGS)];
    int standing_count = 0, entry_count = 0;
    Py_ssize_t order, first_face;
    if (read_size(args[9], &order) < 0 || read_size(args[10], &first_face) < 0 || read_bounds(args[5], &bounds) < 0
        || read_doubles(args[6], 2, slopes) < 0)
        return NULL;
    int told = read_standing(args[7], standing, &standing_count);
    Py_ssize_t size = PyList_Check(bodies) || PyTuple_Check(bodies) ? PySequence_Fast_GET_SIZE(bodies) : 0;
    if (told > 0 && (size < 1 || size > MOST_MOVED || !PyList_Check(others) || PyList_GET_SIZE(others) != size
                     || !PyList_Check(lines) || PyList_GET_SIZE(lines) != size || !PyList_Check(reaches)
                     || PyList_GET_SIZE(reaches) != size || !PyList_Check(pegs) || PyList_GET_SIZE(pegs) != size
                     || !PyList_Check(heap)))
        told = 0;
    for (Py_ssize_t k = 0; told > 0 && k < size; k++)
        told = take(&moved[k], bodies, others, lines, reaches, pegs, k);
    for (Py_ssize_t k = 0; told > 0 && k < size; k++)
        told = meet_walls(&moved[k], moved[k].lines, slopes[0], slopes[1], first_face, standing, standing_count, entries,
                          &entry_count);
    for (Py_ssize_t k = 0; told > 0 && k < size; k++)
        told = meet_pegs(&moved[k], standing, standing_count, entries, &entry_count);
    for (Py_ssize_t k = 0; told > 0 && k < size; k++)
        told = meet_circles(&moved[k], moved, size, moved[k].others, moved[k].reaches, &bounds, standing, standing_count,
                            entries, &entry_count);
    for (Py_ssize_t k = 0; told > 0 && k < size; k++)
        if (set_until(&moved[k]) < 0)
            told = -1;
    for (int k = 0; told > 0 && k < entry_count; k++)
        if (push(heap, &entries[k], ++order) < 0)
            told = -1;
    for (Py_ssize_t k = 0; k < MOST_MOVED; k++) {
        Py_XDECREF(moved[k].body);
        Py_XDECREF(moved[k].others);
        Py_XDECREF(moved[k].lines);
        Py_XDECREF(moved[k].reaches);
        Py_XDECREF(moved[k].pegs);
    }
    return told < 0 ? NULL : told == 0 ? Py_NewRef(Py_None) : PyLong_FromSsize_t(order);
}

/* -- the next arrival: `ArrivalQueue.alone` */

/* Whether a plain arrival rests on a flight that is over; -1 with an error set. */
static int is_stale(PyObject *entry, PyObject *bodies)
{
    for (int k = 0; k < 2; k++) {
        PyObject *index = PyTuple_GET_ITEM(entry, 3 + k);
        Py_ssize_t i, serial, then;
        if (read_size(index, &i) < 0)
            return -1;
        if (k == 1 && i < 0)
            break;
        PyObject *body = PyDict_GetItemWithError(bodies, index);
        if (body == NULL) {
            if (!PyErr_Occurred())
                PyErr_SetObject(PyExc_KeyError, index);
            return -1;
        }
        if (get_number(body, IS_SERIAL, &serial) < 0 || read_size(PyTuple_GET_ITEM(entry, 5 + k), &then) < 0)
            return -1;
        if (serial != then)
            return 1;
    }
    return 0;
}

static int is_plain(PyObject *entry)
{
    return PyTuple_CheckExact(entry) && PyTuple_GET_SIZE(entry) == PLAIN;
}

/* The first of a heap, borrowed, once plain arrivals that are stale are taken off; NULL if it is empty or not plain, or
 * with an error set. */
static PyObject *head(PyObject *heap, PyObject *bodies, double high)
{
    while (PyList_GET_SIZE(heap) > 0) {
        PyObject *entry = PyList_GET_ITEM(heap, 0);
        double low;
        if (!is_plain(entry) || read_double(PyTuple_GET_ITEM(entry, 0), &low) < 0)
            return NULL;
        if (low > high)
            return entry;
        int stale = is_stale(entry, bodies);
        if (stale <= 0)
            return stale < 0 ? NULL : entry;
        PyObject *popped = PyObject_CallOneArg(heappop, heap);
        if (popped == NULL)
            return NULL;
        Py_DECREF(popped);
    }
    return NULL;
}

PyDoc_STRVAR(first_doc,
"first(heap, bodies, before): takes off the next plain arrival if it comes before a time and nothing else may come with\n"
"it. None where that is not so, or not seen here: then nothing but stale arrivals is gone.");

static PyObject *first(PyObject *self, PyObject *const *args, Py_ssize_t count)
{
    if (count != 3 || !PyList_Check(args[0])) {
        PyErr_SetString(PyExc_TypeError, "first: a list, bodies, and a time");
        return NULL;
    }
    if (!PyDict_Check(args[1]))
        Py_RETURN_NONE;
    PyObject *heap = args[0], *bodies = args[1];
    double before, high;
    if (read_double(args[2], &before) < 0)
        return NULL;
    PyObject *entry = head(heap, bodies, INFINITY);
    if (entry == NULL || read_double(PyTuple_GET_ITEM(entry, 2), &high) < 0 || !(high < before))
        return PyErr_Occurred() ? NULL : Py_NewRef(Py_None);
    PyObject *found = PyObject_CallOneArg(heappop, heap);
    if (found == NULL)
        return NULL;
    PyObject *next = head(heap, bodies, high);
    double low = INFINITY;
    int alone = !PyErr_Occurred();
    if (alone && PyList_GET_SIZE(heap) > 0)
        alone = next != NULL && read_double(PyTuple_GET_ITEM(next, 0), &low) == 0 && low > high;
    if (alone)
        return found;
    PyObject *type, *value, *trace;
    PyErr_Fetch(&type, &value, &trace);
    PyObject *both[] = {heap, found}, *done = PyObject_Vectorcall(heappush, both, 2, NULL);
    Py_DECREF(found);
    if (done == NULL) {
        Py_XDECREF(type);
        Py_XDECREF(value);
        Py_XDECREF(trace);
        return NULL;
    }
    Py_DECREF(done);
    PyErr_Restore(type, value, trace);
    return PyErr_Occurred() ? NULL : Py_NewRef(Py_None);
}

static PyMethodDef methods[] = {
    {"falls", (PyCFunction)(void (*)(void))falls, METH_FASTCALL, falls_doc},
    {"faces", (PyCFunction)(void (*)(void))faces, METH_FASTCALL, faces_doc},
    {"falling_zero", (PyCFunction)(void (*)(void))first_fall, METH_FASTCALL, falling_zero_doc},
    {"onto_peg", (PyCFunction)(void (*)(void))peg_met, METH_FASTCALL, onto_peg_doc},
    {"onto_side", (PyCFunction)(void (*)(void))side_met, METH_FASTCALL, onto_side_doc},
    {"first", (PyCFunction)(void (*)(void))first, METH_FASTCALL, first_doc},
    {"pairs", (PyCFunction)(void (*)(void))pairs, METH_FASTCALL, pairs_doc},
    {"walls", (PyCFunction)(void (*)(void))walls, METH_FASTCALL, walls_doc},
    {"predict", (PyCFunction)(void (*)(void))predict, METH_FASTCALL, predict_doc},
    {NULL, NULL, 0, NULL},
};

static struct PyModuleDef module = {
    PyModuleDef_HEAD_INIT, "_predictions", "Predictions in doubles, compiled: see filtered.py.", -1, methods,
    NULL, NULL, NULL, NULL,
};

PyMODINIT_FUNC PyInit__predictions(void)
{
    PyObject *heapq = PyImport_ImportModule("heapq");
    if (heapq == NULL)
        return NULL;
    heappush = PyObject_GetAttrString(heapq, "heappush");
    heappop = PyObject_GetAttrString(heapq, "heappop");
    Py_DECREF(heapq);
    const Name names[] = {{&names_of[IS_F], "f"}, {&names_of[IS_KIND], "kind"}, {&names_of[IS_INDEX], "index"},
                          {&names_of[IS_SERIAL], "serial"}, {&names_of[IS_UNTIL], "until"}, {NULL, NULL}};
    infinity = PyFloat_FromDouble(INFINITY);
    if (heappush == NULL || heappop == NULL || infinity == NULL || intern(names) < 0)
        return NULL;
    return PyModule_Create(&module);
}
