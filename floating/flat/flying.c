/* `pairs` and `walls` of flying.py, compiled: the same operations on doubles in the same order, so the same bits; the
 * same entries are queued in the same order. Built where there is a compiler; without it, flying.py runs.
 */
#include "../../exact/compiled/reading.h"

#define ENTRY 8 /* of the queue: time, order, two places, their serial numbers, the wait, and whether it is a graze */

static PyObject *name_flights, *name_until, *name_heap, *name_serial, *name_tick, *name_unsure, *heappush;

enum { X, Y, VX, VY, AT, R, PLACE, FLIGHT };

/* The run's own, of a `FlatFlights`, while one circle is held against others. */
typedef struct {
    PyObject *run, *i, *standing, *until, *heap, *serial, *tick;
    Py_ssize_t at;
    double own[PLACE];
} Held;

static void let_go(Held *held)
{
    Py_CLEAR(held->until);
    Py_CLEAR(held->heap);
    Py_CLEAR(held->serial);
    Py_CLEAR(held->tick);
}

/* All of a flight but its place. */
static int read_flight(PyObject *flight, double *out)
{
    if (!PyTuple_Check(flight) || PyTuple_GET_SIZE(flight) != FLIGHT) {
        PyErr_SetString(PyExc_TypeError, "a flight is a tuple of seven");
        return -1;
    }
    for (int k = 0; k < PLACE; k++)
        if (read_double(PyTuple_GET_ITEM(flight, k), &out[k]) < 0)
            return -1;
    return 0;
}

static int take(PyObject *const *args, Py_ssize_t count, Held *held)
{
    *held = (Held){0};
    if (count != 4) {
        PyErr_SetString(PyExc_TypeError, "flights, a circle, the others and those that are passed over are expected");
        return -1;
    }
    held->run = args[0];
    held->i = args[1];
    held->standing = args[3];
    PyObject *flights = PyObject_GetAttr(held->run, name_flights), *flight = NULL;
    if (flights != NULL && read_size(held->i, &held->at) == 0)
        flight = item(flights, held->at);
    int failed = flight == NULL || read_flight(flight, held->own) < 0;
    Py_XDECREF(flight);
    Py_XDECREF(flights);
    if (failed)
        return -1;
    if ((held->until = PyObject_GetAttr(held->run, name_until)) == NULL
        || (held->heap = PyObject_GetAttr(held->run, name_heap)) == NULL
        || (held->serial = PyObject_GetAttr(held->run, name_serial)) == NULL
        || (held->tick = PyObject_GetAttr(held->run, name_tick)) == NULL) {
        let_go(held);
        return -1;
    }
    return 0;
}

/* Queues a hit; none of what is given is borrowed from a list. */
static int push(const Held *held, double time, PyObject *place, PyObject *serial, PyObject *other_serial, double wait)
{
    PyObject *order = PyObject_CallNoArgs(held->tick);
    if (order == NULL)
        return -1;
    PyObject *items[] = {PyFloat_FromDouble(time), order, Py_NewRef(held->i), Py_NewRef(place), Py_NewRef(serial),
                         Py_NewRef(other_serial), PyFloat_FromDouble(wait), Py_NewRef(Py_False)};
    PyObject *made = filled(PyTuple_New(ENTRY), items, ENTRY);
    if (made == NULL)
        return -1;
    PyObject *both[] = {held->heap, made}, *done = PyObject_Vectorcall(heappush, both, 2, NULL);
    Py_DECREF(made);
    Py_XDECREF(done);
    return done == NULL ? -1 : 0;
}

static int look_closer(const Held *held, PyObject *place)
{
    PyObject *given[] = {held->run, held->i, place};
    PyObject *done = PyObject_VectorcallMethod(name_unsure, given, 3 | PY_VECTORCALL_ARGUMENTS_OFFSET, NULL);
    Py_XDECREF(done);
    return done == NULL ? -1 : 0;
}

static int passed_over(const Held *held, PyObject *place)
{
    return PySequence_Contains(held->standing, place);
}

/* One pass of the loop of `pairs`; `until` is that of the circle. */
static int pair(const Held *held, PyObject *other, double until)
{
    const double *a = held->own;
    double b[PLACE], theirs;
    Py_ssize_t j;
    if (read_flight(other, b) < 0)
        return -1;
    double lag = a[AT] - b[AT];
    double dx = b[X] + b[VX] * lag - a[X];
    double dy = b[Y] + b[VY] * lag - a[Y];
    double vx = b[VX] - a[VX];
    double vy = b[VY] - a[VY];
    double approach = dx * vx + dy * vy;
    if (approach >= 0.0)
        return 0;
    double reach = a[R] + b[R];
    double cross = dx * vy - dy * vx;
    double disc = (vx * vx + vy * vy) * (reach * reach) - cross * cross;
    if (disc < 0.0)
        return 0;
    double gap = dx * dx + dy * dy - reach * reach;
    PyObject *place = PyTuple_GET_ITEM(other, PLACE);
    if (disc > 0.0 && approach < 0.0 && gap > 0.0) {
        double wait = gap / (sqrt(disc) - approach);
        double time = a[AT] + wait;
        if (time > until)
            return 0;
        if (read_size(place, &j) < 0 || item_double(held->until, j, &theirs) < 0)
            return -1;
        if (time > theirs)
            return 0;
        int passed = passed_over(held, place);
        if (passed != 0)
            return passed < 0 ? -1 : 0;
        PyObject *mine = item(held->serial, held->at), *their_serial = item(held->serial, j);
        int failed = mine == NULL || their_serial == NULL || push(held, time, place, mine, their_serial, wait) < 0;
        Py_XDECREF(mine);
        Py_XDECREF(their_serial);
        return failed ? -1 : 0;
    }
    int passed = passed_over(held, place);
    return passed < 0 ? -1 : passed ? 0 : look_closer(held, place);
}

#define LINE 8 /* place, x0, y0, nx, ny, r |n|, |n|^2, and whether it is a face */

/* One pass of the loop of `walls`. */
static int wall(const Held *held, PyObject *line, PyObject *serial, PyObject *zero)
{
    const double *a = held->own;
    double told[6], until;
    enum { FROM_X, FROM_Y, NX, NY, OFFSET, SQUARE };
    if (!PyTuple_Check(line) || PyTuple_GET_SIZE(line) != LINE) {
        PyErr_SetString(PyExc_TypeError, "a line is a tuple of eight");
        return -1;
    }
    int is_face = PyTuple_GET_ITEM(line, LINE - 1) == Py_True;
    for (int k = 0; k < 5 + is_face; k++)
        if (read_double(PyTuple_GET_ITEM(line, k + 1), &told[k]) < 0)
            return -1;
    PyObject *place = PyTuple_GET_ITEM(line, 0);
    double nx = told[NX], ny = told[NY], x = a[X] - told[FROM_X], y = a[Y] - told[FROM_Y];
    double approach = a[VX] * nx + a[VY] * ny;
    if (approach > 0.0 || (approach == 0.0 && !is_face))
        return 0;
    double gap = x * nx + y * ny - told[OFFSET], along = 0.0;
    if (is_face) {
        if (approach == 0.0 && (gap < 0.0 || gap > 0.0))
            return 0;
        along = x * ny - y * nx;
        if (gap < 0.0 && (gap + told[OFFSET] <= 0.0 || along <= 0.0 || told[SQUARE] - along <= 0.0))
            return 0;
    }
    int passed = passed_over(held, place);
    if (passed != 0)
        return passed < 0 ? -1 : 0;
    if (!(approach < 0.0 && gap > 0.0))
        return look_closer(held, place);
    if (is_face) {
        double foot = (a[VX] * ny - a[VY] * nx) * gap - along * approach;
        double beyond = -((nx * nx + ny * ny) * approach) - foot;
        if (foot < 0.0 || beyond < 0.0)
            return 0;
        if (!(foot > 0.0 && beyond > 0.0))
            return look_closer(held, place);
    }
    double wait = -gap / approach;
    double time = a[AT] + wait;
    if (item_double(held->until, held->at, &until) < 0)
        return -1;
    if (time > until)
        return 0;
    if (time < until) {
        PyObject *end = PyFloat_FromDouble(time);
        if (end == NULL || PyList_SetItem(held->until, held->at, end) < 0)
            return -1;
    }
    return push(held, time, place, serial, zero, wait);
}

PyDoc_STRVAR(pairs_doc, "pairs(f, i, others, standing): see flying.py.");

static PyObject *pairs(PyObject *self, PyObject *const *args, Py_ssize_t count)
{
    Held held;
    double until = 0.0;
    if (take(args, count, &held) < 0)
        return NULL;
    PyObject *others = PySequence_Fast(args[2], "pairs: others");
    int failed = others == NULL || item_double(held.until, held.at, &until) < 0;
    for (Py_ssize_t k = 0; !failed && k < PySequence_Fast_GET_SIZE(others); k++) {
        PyObject *other = Py_NewRef(PySequence_Fast_GET_ITEM(others, k));
        failed = pair(&held, other, until) < 0;
        Py_DECREF(other);
    }
    Py_XDECREF(others);
    let_go(&held);
    return failed ? NULL : Py_NewRef(Py_None);
}

PyDoc_STRVAR(walls_doc, "walls(f, i, lines, standing): see flying.py.");

static PyObject *walls(PyObject *self, PyObject *const *args, Py_ssize_t count)
{
    Held held;
    if (take(args, count, &held) < 0)
        return NULL;
    PyObject *lines = PySequence_Fast(args[2], "walls: lines"), *zero = PyLong_FromLong(0);
    PyObject *serial = lines == NULL || zero == NULL ? NULL : item(held.serial, held.at);
    int failed = serial == NULL;
    for (Py_ssize_t k = 0; !failed && k < PySequence_Fast_GET_SIZE(lines); k++) {
        PyObject *line = Py_NewRef(PySequence_Fast_GET_ITEM(lines, k));
        failed = wall(&held, line, serial, zero) < 0;
        Py_DECREF(line);
    }
    Py_XDECREF(serial);
    Py_XDECREF(zero);
    Py_XDECREF(lines);
    let_go(&held);
    return failed ? NULL : Py_NewRef(Py_None);
}

static PyMethodDef methods[] = {
    {"pairs", (PyCFunction)(void (*)(void))pairs, METH_FASTCALL, pairs_doc},
    {"walls", (PyCFunction)(void (*)(void))walls, METH_FASTCALL, walls_doc},
    {NULL, NULL, 0, NULL},
};

static struct PyModuleDef module = {
    PyModuleDef_HEAD_INIT, "_flying", "Predictions on flat flights, compiled: see flying.py.", -1, methods,
    NULL, NULL, NULL, NULL,
};

PyMODINIT_FUNC PyInit__flying(void)
{
    PyObject *heapq = PyImport_ImportModule("heapq");
    if (heapq == NULL)
        return NULL;
    heappush = PyObject_GetAttrString(heapq, "heappush");
    Py_DECREF(heapq);
    const Name names[] = {{&name_flights, "flights"}, {&name_until, "until"}, {&name_heap, "heap"},
                          {&name_serial, "serial"}, {&name_tick, "tick"}, {&name_unsure, "unsure"}, {NULL, NULL}};
    if (heappush == NULL || intern(names) < 0)
        return NULL;
    return PyModule_Create(&module);
}
