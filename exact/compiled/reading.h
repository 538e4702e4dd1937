/* Python's numbers and attributes, read as C's; shared by the modules of this folder. */
#ifndef TRUEBREAK_READING_H
#define TRUEBREAK_READING_H

#define PY_SSIZE_T_CLEAN
#include <Python.h>
#include <float.h>
#include <math.h>

#if FLT_EVAL_METHOD != 0
#error "doubles are kept wider than they are: the Python is used"
#endif

#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__) || defined(__ASSOCIATIVE_MATH__) \
    || defined(__RECIPROCAL_MATH__) || defined(__NO_SIGNED_ZEROS__) || defined(_M_FP_FAST)
#error "arithmetic of doubles is not kept as it is written: the Python is used"
#endif

#ifdef _MSC_VER
#pragma fp_contract(off) /* before Visual Studio 2022 it was on; others have -ffp-contract=off from pyproject.toml */
#endif

#define UNIT 0x1p-53

/* Each gives 0, or -1 with an error set. */

static inline int read_double(PyObject *number, double *out)
{
    if (PyFloat_CheckExact(number)) {
        *out = PyFloat_AS_DOUBLE(number);
        return 0;
    }
    *out = PyFloat_AsDouble(number);
    return *out == -1.0 && PyErr_Occurred() ? -1 : 0;
}

/* All numbers of a tuple, or of its end. */
static inline int read_doubles(PyObject *tuple, Py_ssize_t count, double *out)
{
    Py_ssize_t from = PyTuple_Check(tuple) ? PyTuple_GET_SIZE(tuple) - count : -1;
    if (from < 0) {
        PyErr_SetString(PyExc_TypeError, "a tuple of numbers is expected");
        return -1;
    }
    for (Py_ssize_t k = 0; k < count; k++)
        if (read_double(PyTuple_GET_ITEM(tuple, from + k), &out[k]) < 0)
            return -1;
    return 0;
}

static inline int read_size(PyObject *number, Py_ssize_t *out)
{
    *out = PyLong_AsSsize_t(number);
    return *out == -1 && PyErr_Occurred() ? -1 : 0;
}

static inline int get_double(PyObject *of, PyObject *name, double *out)
{
    PyObject *value = PyObject_GetAttr(of, name);
    int failed = value == NULL || read_double(value, out) < 0;
    Py_XDECREF(value);
    return failed ? -1 : 0;
}

static inline int get_size(PyObject *of, PyObject *name, Py_ssize_t *out)
{
    PyObject *value = PyObject_GetAttr(of, name);
    int failed = value == NULL || read_size(value, out) < 0;
    Py_XDECREF(value);
    return failed ? -1 : 0;
}

/* A list's item, owned; NULL with an error set. */
static inline PyObject *item(PyObject *list, Py_ssize_t at)
{
    if (PyList_Check(list) && at >= 0 && at < PyList_GET_SIZE(list))
        return Py_NewRef(PyList_GET_ITEM(list, at));
    PyErr_SetString(PyExc_IndexError, "a list without such a place");
    return NULL;
}

/* A list's double. */
static inline int item_double(PyObject *list, Py_ssize_t at, double *out)
{
    PyObject *number = item(list, at);
    int failed = number == NULL || read_double(number, out) < 0;
    Py_XDECREF(number);
    return failed ? -1 : 0;
}

/* Puts an object that is made for it, or NULL with an error set, at the end of a list. */
static inline int append(PyObject *list, PyObject *made)
{
    int failed = made == NULL || PyList_Append(list, made) < 0;
    Py_XDECREF(made);
    return failed ? -1 : 0;
}

/* Fills a tuple that has just been made, or is NULL, with objects that are made for it; NULL, and nothing left, where one
 * of them is. Several times as fast as `Py_BuildValue`. */
static inline PyObject *filled(PyObject *tuple, PyObject **items, Py_ssize_t count)
{
    int failed = tuple == NULL;
    for (Py_ssize_t k = 0; k < count; k++)
        failed = failed || items[k] == NULL;
    for (Py_ssize_t k = 0; k < count; k++)
        if (failed)
            Py_XDECREF(items[k]);
        else
            PyTuple_SET_ITEM(tuple, k, items[k]);
    if (failed)
        Py_CLEAR(tuple);
    return tuple;
}

/* The interned names of a module: given as pairs of where and what, ended by NULL. */
typedef struct { PyObject **where; const char *what; } Name;

static inline int intern(const Name *names)
{
    for (; names->where != NULL; names++)
        if ((*names->where = PyUnicode_InternFromString(names->what)) == NULL)
            return -1;
    return 0;
}

#endif
