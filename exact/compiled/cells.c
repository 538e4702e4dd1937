/* `Cells` of cells.py, compiled: the same operations on doubles in the same order, and so the same answers; what they
 * rest on is derived there. Which circle is where stands in arrays, a cell's circles are linked by number, and crossings
 * wait in one heap by slice of time. Built where there is a compiler; without it, the Python runs.
 */
#include "lists.h"
#include "structmember.h"

#define FARTHEST 1e100
#define SLOWEST 1e-200
#define ROOM 2.0
#define NOWHERE (-1)

typedef struct { double x, y, vx, vy, t; } Flight;

typedef struct {
    PyObject_HEAD
    double next_crossing, early;
    double x, y, width, last_x, last_y, margin, sharp, farthest, fastest, rate, calm;
    int columns, rows, row, count, loose_count;
    long long flights_begun;
    double *left, *right, *low, *high; /* where cells are left, by column and by row */
    Lists held;
    int *cell, *loose, *loose_at, *found, *fresh;
    char *is_large;
    Flight *flights;
    long long *begun;
    Known *known;
    Crossings waiting, due;
    PyObject **numbers, **known_walls; /* each circle's number, and the bits of the walls it knows, or NULL */
    PyObject *walls, *near, *every;
} Cells;

static PyObject *name_indices, *none_near;

/* -- one circle */

static void drop(Cells *self, int i)
{
    int at = self->loose_at[i];
    if (at != NOBODY) {
        int last = self->loose[--self->loose_count];
        self->loose[at] = last;
        self->loose_at[last] = at;
        self->loose_at[i] = NOBODY;
    }
    if (self->cell[i] != NOWHERE) {
        part(&self->held, self->cell[i], i);
        self->cell[i] = NOWHERE;
    }
}

static void loosen(Cells *self, int i)
{
    drop(self, i);
    self->loose_at[i] = self->loose_count;
    self->loose[self->loose_count++] = i;
}

static void move(Cells *self, int i, int cell)
{
    if (self->cell[i] != NOWHERE)
        part(&self->held, self->cell[i], i);
    join(&self->held, cell, i);
    self->cell[i] = cell;
}

static int await(Cells *self, Crossing crossing)
{
    crossing.slice = trunc(crossing.time * self->rate) + 0.0;
    if (!isfinite(crossing.slice)) {
        PyErr_SetString(PyExc_OverflowError, "a crossing beyond all time");
        return -1;
    }
    if (queue(&self->waiting, crossing) < 0)
        return -1;
    self->next_crossing = self->waiting.of[0].slice / self->rate;
    return 0;
}

/* `Cells._foresee`. */
static int foresee(Cells *self, int i, int column, int row)
{
    const Flight *f = &self->flights[i];
    double wait = INFINITY, up;
    int step = 0;
    if (f->vx > 0.0) {
        wait = (self->right[column] - f->x) / f->vx;
        step = 1;
    } else if (f->vx < 0.0) {
        wait = (self->left[column] - f->x) / f->vx;
        step = -1;
    }
    if (f->vy > 0.0) {
        up = (self->high[row] - f->y) / f->vy;
        if (up < wait) {
            wait = up;
            step = self->row;
        }
    } else if (f->vy < 0.0) {
        up = (self->low[row] - f->y) / f->vy;
        if (up < wait) {
            wait = up;
            step = -self->row;
        }
    }
    double time = f->t + wait;
    if (!(f->t <= time && time < self->calm)) {
        double last = wait == INFINITY || wait < 0.0 ? f->t : time;
        if (!(fabs(f->x) + fabs(f->y) + (fabs(f->vx) + fabs(f->vy)) * last < self->sharp && last < FARTHEST)) {
            loosen(self, i);
            return 0;
        }
        if (wait == INFINITY)
            return 0;
    }
    return await(self, (Crossing){.time = time, .begun = self->begun[i], .circle = i, .step = step});
}

/* `Cells._slice_anew`: what waits is queued in the order in which Python has it, slices by their first crossing. */
static int slice_anew(Cells *self, double fastest)
{
    Crossings old = self->waiting;
    sort_crossings(&old);
    double slice = 0.0, first = 0.0;
    for (size_t k = 0; k < old.count; k++) {
        if (k == 0 || old.of[k].slice != slice) {
            slice = old.of[k].slice;
            first = (double)old.of[k].order;
        }
        old.of[k].slice = first;
    }
    sort_crossings(&old);
    self->fastest = fastest;
    self->rate = 2.0 * fastest / self->margin;
    self->next_crossing = INFINITY;
    self->early = 1.0 / self->rate;
    self->waiting = (Crossings){.order = old.order};
    int failed = 0;
    for (size_t k = 0; k < old.count && !failed; k++)
        if (self->begun[old.of[k].circle] == old.of[k].begun)
            failed = await(self, old.of[k]);
    PyMem_Free(old.of);
    return failed;
}

/* `Cells._admit`: 1 if it can be held, 0 if not, -1 with an error set. */
static int admit(Cells *self, const Flight *f)
{
    double far = fabs(f->x) + fabs(f->y), fast = fabs(f->vx) + fabs(f->vy);
    if (!(far < FARTHEST && fast < FARTHEST / 8 * self->margin))
        return 0;
    if (fast > self->fastest) {
        if (!(fast > SLOWEST * self->margin))
            return 0;
        double most = fabs(f->vy) > fabs(f->vx) ? fabs(f->vy) : fabs(f->vx);
        if (slice_anew(self, ROOM * most) < 0)
            return -1;
    }
    if (far > self->farthest)
        self->farthest = far;
    if (self->fastest > 0.0) {
        double calm = (self->sharp - self->farthest) / (2.0 * self->fastest);
        self->calm = calm > FARTHEST ? FARTHEST : calm;
    }
    return 1;
}

/* Which of some cells in a row, the outer of which reach out without end, a place falls in. */
static int place(double along, double width, int count)
{
    double cells = along / width;
    return !(cells > 0.0) ? 0 : cells >= count ? count - 1 : (int)cells;
}

/* -- what is near */

static int all(const Cells *self, int *found)
{
    int count = 0;
    for (int k = 0; k < self->count; k++)
        if (self->cell[k] != NOWHERE)
            found[count++] = k;
    for (int k = 0; k < self->loose_count; k++)
        found[count++] = self->loose[k];
    return count;
}

/* 1 if there may be walls near a cell, 0 if none is, -1 with an error set. */
static int may_have_walls(const Cells *self, int cell)
{
    PyObject *near = item(self->near, cell);
    int may = near == NULL ? -1 : near == Py_None ? 1 : PyObject_IsTrue(near);
    Py_XDECREF(near);
    return may;
}

/* `Cells.walls`. */
static PyObject *walls_of(Cells *self, int i)
{
    int cell = self->cell[i];
    PyObject *known = self->known_walls[i], *near, *fresh = NULL, *both = NULL, *found = NULL;
    near = cell == NOWHERE ? Py_NewRef(self->every) : item(self->near, cell);
    if (near == Py_None) {
        Py_DECREF(near);
        near = PyObject_CallMethod(self->walls, "look", "iii", cell, cell % self->row - 1, cell / self->row - 1);
    }
    int any = near == NULL ? -1 : PyObject_IsTrue(near);
    if (any <= 0) {
        Py_XDECREF(near);
        return any < 0 ? NULL : Py_NewRef(none_near);
    }
    if (known == NULL) {
        fresh = Py_NewRef(near);
        both = Py_NewRef(near);
    } else {
        PyObject *others = PyNumber_Invert(known);
        fresh = others == NULL ? NULL : PyNumber_And(near, others);
        both = fresh == NULL ? NULL : PyNumber_Or(known, near);
        Py_XDECREF(others);
    }
    if (both != NULL) {
        Py_XSETREF(self->known_walls[i], both);
        found = PyObject_CallMethodOneArg(self->walls, name_indices, fresh);
    }
    Py_XDECREF(fresh);
    Py_DECREF(near);
    return found;
}

static PyObject *listed(const Cells *self, const int *numbers, int count)
{
    PyObject *list = PyList_New(count);
    for (int k = 0; list != NULL && k < count; k++)
        PyList_SET_ITEM(list, k, Py_NewRef(self->numbers[numbers[k]]));
    return list;
}

/* `Cells._new`, of those found: into `fresh`; how many, or -1 with an error set. */
static int hand_out(Cells *self, int i, int count)
{
    Known *known = self->known;
    long long own = self->begun[i];
    int fresh = 0, newer = 0;
    for (int at = 0; at < count; at++) {
        int k = self->found[at];
        if (own > self->begun[k]) {
            if (!knows(&known[i], k))
                self->fresh[fresh++] = k;
        } else if (k != i && !knows(&known[k], i)) {
            if (know(&known[k], &i, 1) < 0)
                return -1;
            self->fresh[fresh++] = k;
            newer++;
        }
    }
    if (newer < fresh && know(&known[i], self->fresh, fresh) < 0)
        return -1;
    sort_numbers(self->fresh, fresh);
    return fresh;
}

/* -- Python's methods */

static int read_circle(const Cells *self, PyObject *number, int *i)
{
    Py_ssize_t told;
    if (read_size(number, &told) < 0)
        return -1;
    if (told < 0 || told >= self->count) {
        PyErr_SetString(PyExc_IndexError, "no such circle");
        return -1;
    }
    *i = (int)told;
    return 0;
}

static void begin(Cells *self, int i)
{
    self->begun[i] = ++self->flights_begun;
    Py_CLEAR(self->known_walls[i]);
}

static PyObject *enter(Cells *self, PyObject *const *args, Py_ssize_t count)
{
    int i, column = 0, row = 0, held = 0;
    double told[5];
    if (count != 2) {
        PyErr_SetString(PyExc_TypeError, "enter: a circle and its flight");
        return NULL;
    }
    if (read_circle(self, args[0], &i) < 0)
        return NULL;
    if (!PyTuple_Check(args[1]) || PyTuple_GET_SIZE(args[1]) != 5) {
        PyErr_SetString(PyExc_TypeError, "enter: a flight is a tuple of five");
        return NULL;
    }
    if (read_doubles(args[1], 5, told) < 0)
        return NULL;
    Flight f = {told[0], told[1], told[2], told[3], told[4]};
    begin(self, i);
    double fastest = self->fastest;
    if (!self->is_large[i]) {
        int inside = self->x <= f.x && f.x <= self->last_x && self->y <= f.y && f.y <= self->last_y
            && -fastest <= f.vx && f.vx <= fastest && -fastest <= f.vy && f.vy <= fastest;
        held = inside ? 1 : admit(self, &f);
        if (held < 0)
            return NULL;
    }
    if (!held) {
        loosen(self, i);
        Py_RETURN_TRUE;
    }
    column = place(f.x - self->x, self->width, self->columns);
    row = place(f.y - self->y, self->width, self->rows);
    int cell = (row + 1) * self->row + column + 1;
    if (self->loose_at[i] != NOBODY)
        drop(self, i);
    if (cell != self->cell[i])
        move(self, i, cell);
    self->flights[i] = f;
    if (foresee(self, i, column, row) < 0)
        return NULL;
    int near = may_have_walls(self, cell);
    return near < 0 ? NULL : PyBool_FromLong(near || self->loose_count > 0);
}

static PyObject *enter_loose(Cells *self, PyObject *number)
{
    int i;
    if (read_circle(self, number, &i) < 0)
        return NULL;
    begin(self, i);
    loosen(self, i);
    Py_RETURN_NONE;
}

static PyObject *remove_circle(Cells *self, PyObject *number)
{
    int i;
    if (read_circle(self, number, &i) < 0)
        return NULL;
    drop(self, i);
    Py_RETURN_NONE;
}

static PyObject *around(Cells *self, PyObject *number)
{
    int i, count = 0, others = 0, *found = self->found;
    if (read_circle(self, number, &i) < 0)
        return NULL;
    int cell = self->cell[i];
    if (cell == NOWHERE) {
        count = all(self, found);
    } else {
        for (int row = cell - self->row; row <= cell + self->row; row += self->row)
            for (int near = row - 1; near <= row + 1; near++)
                count = gather(&self->held, near, found, count);
        for (int k = 0; k < self->loose_count; k++)
            found[count++] = self->loose[k];
    }
    for (int k = 0; k < count; k++)
        if (found[k] != i)
            found[others++] = found[k];
    if (others == count) {
        PyErr_SetString(PyExc_ValueError, "a circle that has not been entered");
        return NULL;
    }
    sort_numbers(found, others);
    self->known[i].count = 0;
    return know(&self->known[i], found, others) < 0 ? NULL : listed(self, found, others);
}

static PyObject *walls(Cells *self, PyObject *number)
{
    int i;
    return read_circle(self, number, &i) < 0 ? NULL : walls_of(self, i);
}

/* A crossing that is due: 1 if it is carried out, and appended; 0 if its flight is over; -1 with an error set. */
static int cross_one(Cells *self, const Crossing *due, double before, PyObject *crossed)
{
    int i = due->circle, count = 0, near = 1;
    if (self->begun[i] != due->begun || self->cell[i] == NOWHERE)
        return 0;
    int cell = self->cell[i] + due->step;
    move(self, i, cell);
    if (foresee(self, i, cell % self->row - 1, cell / self->row - 1) < 0)
        return -1;
    if (before > self->early && self->cell[i] != NOWHERE) {
        double across = fabs(self->flights[i].vx), up = fabs(self->flights[i].vy);
        if (!(before * (up > across ? up : across) < self->margin / 2))
            loosen(self, i);
    }
    if (self->cell[i] == NOWHERE) {
        count = all(self, self->found);
    } else {
        int aside = due->step == 1 || due->step == -1 ? self->row : 1;
        for (int k = -1; k <= 1; k++)
            count = gather(&self->held, cell + due->step + k * aside, self->found, count);
        near = may_have_walls(self, cell);
    }
    int fresh = near < 0 ? -1 : hand_out(self, i, count);
    if (fresh < 0)
        return -1;
    PyObject *others = listed(self, self->fresh, fresh);
    if (others == NULL)
        return -1;
    PyObject *parts[] = {Py_NewRef(self->numbers[i]), others, near ? walls_of(self, i) : Py_NewRef(none_near)};
    return append(crossed, filled(PyTuple_New(3), parts, 3)) < 0 ? -1 : 1;
}

static PyObject *cross(Cells *self, PyObject *const *args, Py_ssize_t count)
{
    double since = INFINITY;
    if (count > 1) {
        PyErr_SetString(PyExc_TypeError, "cross: at most a time");
        return NULL;
    }
    if (count == 1 && read_double(args[0], &since) < 0)
        return NULL;
    if (self->waiting.count == 0) {
        PyErr_SetString(PyExc_IndexError, "no circle is to cross");
        return NULL;
    }
    PyObject *crossed = PyList_New(0);
    if (crossed == NULL)
        return NULL;
    double slice = self->waiting.of[0].slice, before = slice / self->rate - since;
    self->due.count = 0;
    self->due.order = 0;
    while (self->waiting.count > 0 && self->waiting.of[0].slice == slice) {
        Crossing next = take_first(&self->waiting);
        next.slice = 0.0;
        if (queue(&self->due, next) < 0)
            goto failed;
    }
    self->next_crossing = self->waiting.count > 0 ? self->waiting.of[0].slice / self->rate : INFINITY;
    for (size_t k = 0; k < self->due.count; k++)
        if (cross_one(self, &self->due.of[k], before, crossed) < 0)
            goto failed;
    return crossed;
failed:
    Py_DECREF(crossed);
    return NULL;
}

static PyObject *get_loose(Cells *self, void *unused)
{
    PyObject *found = PySet_New(NULL);
    for (int k = 0; found != NULL && k < self->loose_count; k++)
        if (PySet_Add(found, self->numbers[self->loose[k]]) < 0)
            Py_CLEAR(found);
    return found;
}

/* -- making and unmaking */

static void dealloc(Cells *self)
{
    PyTypeObject *type = Py_TYPE(self);
    for (int k = 0; k < self->count; k++) {
        if (self->known != NULL)
            PyMem_Free(self->known[k].numbers);
        if (self->numbers != NULL)
            Py_XDECREF(self->numbers[k]);
        if (self->known_walls != NULL)
            Py_XDECREF(self->known_walls[k]);
    }
    void *arrays[] = {self->left, self->right, self->low, self->high, self->held.first, self->held.after,
                      self->held.before, self->cell, self->loose, self->loose_at, self->found, self->fresh,
                      self->is_large, self->flights, self->begun, self->known, self->waiting.of, self->due.of,
                      self->numbers, self->known_walls};
    for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++)
        PyMem_Free(arrays[k]);
    Py_XDECREF(self->walls);
    Py_XDECREF(self->near);
    Py_XDECREF(self->every);
    type->tp_free((PyObject *)self);
    Py_DECREF(type);
}

/* A list's doubles; NULL with an error set, as where there are not so many. */
static double *doubles_of(PyObject *list, int count)
{
    if (!PyList_Check(list) || PyList_GET_SIZE(list) != count) {
        PyErr_SetString(PyExc_ValueError, "Cells: a list of ends for each column, and each row, is expected");
        return NULL;
    }
    double *found = PyMem_Malloc(sizeof(double) * (size_t)count);
    if (found == NULL)
        return (double *)PyErr_NoMemory();
    for (int k = 0; k < count; k++)
        if (item_double(list, k, &found[k]) < 0) {
            PyMem_Free(found);
            return NULL;
        }
    return found;
}

static int read_large(Cells *self, PyObject *large)
{
    PyObject *each = PyObject_GetIter(large), *number;
    int i, failed = each == NULL;
    while (!failed && (number = PyIter_Next(each)) != NULL) {
        failed = read_circle(self, number, &i) < 0;
        Py_DECREF(number);
        if (!failed)
            self->is_large[i] = 1;
    }
    Py_XDECREF(each);
    return failed || PyErr_Occurred() ? -1 : 0;
}

#define NEW(where, size) ((where) = PyMem_Calloc((size) > 0 ? (size_t)(size) : 1, sizeof *(where)))

static int fill(Cells *self, PyObject *const *ends, PyObject *large)
{
    int n = self->count;
    Py_ssize_t cells = (Py_ssize_t)self->row * (self->rows + 2);
    if ((self->left = doubles_of(ends[0], self->columns)) == NULL
        || (self->right = doubles_of(ends[1], self->columns)) == NULL
        || (self->low = doubles_of(ends[2], self->rows)) == NULL
        || (self->high = doubles_of(ends[3], self->rows)) == NULL)
        return -1;
    if (!(self->left[0] == -INFINITY && self->right[self->columns - 1] == INFINITY && self->low[0] == -INFINITY
          && self->high[self->rows - 1] == INFINITY)) {
        PyErr_SetString(PyExc_ValueError, "Cells: the outer cells reach out without end");
        return -1;
    }
    if (!PyList_Check(self->near) || PyList_GET_SIZE(self->near) != cells) {
        PyErr_SetString(PyExc_ValueError, "Cells: the walls near each cell are expected");
        return -1;
    }
    if (!NEW(self->held.first, cells) || !NEW(self->held.after, n) || !NEW(self->held.before, n) || !NEW(self->cell, n)
        || !NEW(self->loose, n) || !NEW(self->loose_at, n) || !NEW(self->found, n) || !NEW(self->fresh, n)
        || !NEW(self->is_large, n) || !NEW(self->flights, n) || !NEW(self->begun, n) || !NEW(self->known, n)
        || !NEW(self->numbers, n) || !NEW(self->known_walls, n)) {
        PyErr_NoMemory();
        return -1;
    }
    for (Py_ssize_t k = 0; k < cells; k++)
        self->held.first[k] = NOBODY;
    for (int k = 0; k < n; k++) {
        self->cell[k] = NOWHERE;
        self->loose_at[k] = NOBODY;
        if ((self->numbers[k] = PyLong_FromLong(k)) == NULL)
            return -1;
    }
    return read_large(self, large);
}

static PyObject *make(PyTypeObject *type, PyObject *args, PyObject *named)
{
    double x, y, width, last_x, last_y, margin, sharp;
    int columns, rows, count;
    PyObject *ends[4], *large, *walls;
    if (named != NULL && PyDict_GET_SIZE(named) > 0) {
        PyErr_SetString(PyExc_TypeError, "Cells: no named arguments");
        return NULL;
    }
    if (!PyArg_ParseTuple(args, "(dddii)(OOOO)(dd)ddiOO:Cells", &x, &y, &width, &columns, &rows, &ends[0], &ends[1],
                          &ends[2], &ends[3], &last_x, &last_y, &margin, &sharp, &count, &large, &walls))
        return NULL;
    if (columns < 1 || rows < 1 || count < 0 || columns > 32000 || rows > 32000) {
        PyErr_SetString(PyExc_ValueError, "Cells: 1 to 32,000 columns and rows, and no less than no circle");
        return NULL;
    }
    Cells *self = (Cells *)type->tp_alloc(type, 0);
    if (self == NULL)
        return NULL;
    self->x = x;
    self->y = y;
    self->width = width;
    self->last_x = last_x;
    self->last_y = last_y;
    self->margin = margin;
    self->sharp = sharp;
    self->columns = columns;
    self->rows = rows;
    self->row = columns + 2;
    self->count = count;
    self->farthest = fabs(x) + fabs(y) + (columns + rows) * width;
    self->next_crossing = self->early = INFINITY;
    self->calm = -INFINITY;
    self->walls = Py_NewRef(walls);
    if ((self->near = PyObject_GetAttrString(walls, "near")) == NULL
        || (self->every = PyObject_GetAttrString(walls, "every")) == NULL || fill(self, ends, large) < 0) {
        Py_DECREF(self);
        return NULL;
    }
    return (PyObject *)self;
}

static PyMethodDef methods[] = {
    {"enter", (PyCFunction)(void (*)(void))enter, METH_FASTCALL, "enter(i, flight): as `Cells.enter`."},
    {"enter_loose", (PyCFunction)enter_loose, METH_O, "enter_loose(i): as `Cells.enter_loose`."},
    {"remove", (PyCFunction)remove_circle, METH_O, "remove(i): as `Cells.remove`."},
    {"around", (PyCFunction)around, METH_O, "around(i): as `Cells.around`."},
    {"walls", (PyCFunction)walls, METH_O, "walls(i): as `Cells.walls`."},
    {"cross", (PyCFunction)(void (*)(void))cross, METH_FASTCALL, "cross(since): as `Cells.cross`."},
    {NULL, NULL, 0, NULL},
};

static PyMemberDef members[] = {
    {"next_crossing", T_DOUBLE, offsetof(Cells, next_crossing), READONLY, "As of `Cells`."},
    {"early", T_DOUBLE, offsetof(Cells, early), READONLY, "As of `Cells`."},
    {NULL, 0, 0, 0, NULL},
};

static PyGetSetDef getters[] = {
    {"loose", (getter)get_loose, NULL, "As of `Cells`, a copy.", NULL},
    {NULL, NULL, NULL, NULL, NULL},
};

static PyType_Slot slots[] = {
    {Py_tp_doc, "Cells(grid, ends, last, margin, sharp, count, large, walls): see cells.py."},
    {Py_tp_new, make},
    {Py_tp_dealloc, dealloc},
    {Py_tp_methods, methods},
    {Py_tp_members, members},
    {Py_tp_getset, getters},
    {0, NULL},
};

static PyType_Spec spec = {"truebreak.exact.compiled._cells.Cells", sizeof(Cells), 0, Py_TPFLAGS_DEFAULT, slots};

static PyObject *constants(PyObject *self, PyObject *unused)
{
    return Py_BuildValue("{sdsdsd}", "FARTHEST", FARTHEST, "SLOWEST", SLOWEST, "ROOM", ROOM);
}

static PyMethodDef functions[] = {
    {"constants", constants, METH_NOARGS, "The numbers of cells.py that are written here again, by name."},
    {NULL, NULL, 0, NULL},
};

static struct PyModuleDef module = {
    PyModuleDef_HEAD_INIT, "_cells", "Circles in cells, compiled: see cells.py.", -1, functions, NULL, NULL, NULL, NULL,
};

PyMODINIT_FUNC PyInit__cells(void)
{
    const Name names[] = {{&name_indices, "indices"}, {NULL, NULL}};
    none_near = PyTuple_New(0);
    PyObject *made = none_near == NULL || intern(names) < 0 ? NULL : PyModule_Create(&module);
    PyObject *type = made == NULL ? NULL : PyType_FromSpec(&spec);
    if (type == NULL || PyModule_AddObjectRef(made, "Cells", type) < 0)
        Py_CLEAR(made);
    Py_XDECREF(type);
    return made;
}
