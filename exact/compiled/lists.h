/* Circles in cells, as lists that are linked by number, and what is queued of them; for cells.c. */
#ifndef TRUEBREAK_LISTS_H
#define TRUEBREAK_LISTS_H

#include "reading.h"
#include <stdlib.h>

#define NOBODY (-1)

/* -- who is in which cell: a list for each, in no order */

typedef struct { int *first, *after, *before; } Lists;

static void join(Lists *lists, int cell, int i)
{
    int next = lists->first[cell];
    lists->after[i] = next;
    lists->before[i] = NOBODY;
    if (next != NOBODY)
        lists->before[next] = i;
    lists->first[cell] = i;
}

static void part(Lists *lists, int cell, int i)
{
    int next = lists->after[i], last = lists->before[i];
    if (next != NOBODY)
        lists->before[next] = last;
    if (last != NOBODY)
        lists->after[last] = next;
    else
        lists->first[cell] = next;
}

/* Puts all of a cell after what has been found; gives how many these now are. */
static int gather(const Lists *lists, int cell, int *found, int count)
{
    for (int k = lists->first[cell]; k != NOBODY; k = lists->after[k])
        found[count++] = k;
    return count;
}

/* -- numbers, ascending, and sets of them in no order */

static int compare_numbers(const void *one, const void *other)
{
    int a = *(const int *)one, b = *(const int *)other;
    return (a > b) - (a < b);
}

static void sort_numbers(int *numbers, int count)
{
    if (count > 32) {
        qsort(numbers, (size_t)count, sizeof *numbers, compare_numbers);
        return;
    }
    for (int k = 1; k < count; k++) {
        int number = numbers[k], at = k;
        for (; at > 0 && numbers[at - 1] > number; at--)
            numbers[at] = numbers[at - 1];
        numbers[at] = number;
    }
}

typedef struct { int *numbers, count, room; } Known;

static int knows(const Known *known, int number)
{
    for (int k = 0; k < known->count; k++)
        if (known->numbers[k] == number)
            return 1;
    return 0;
}

/* Each of these that may fail gives 0, or -1 with an error set. */
static int know(Known *known, const int *numbers, int count)
{
    if (known->room - known->count < count) {
        size_t room = 2 * (size_t)known->count + (size_t)count + 8;
        int *wider = room > INT_MAX ? NULL : PyMem_Realloc(known->numbers, room * sizeof *wider);
        if (wider == NULL) {
            PyErr_NoMemory();
            return -1;
        }
        known->numbers = wider;
        known->room = (int)room;
    }
    for (int k = 0; k < count; k++)
        known->numbers[known->count++] = numbers[k];
    return 0;
}

/* -- crossings, by slice of time, those of one slice in the order in which they were queued */

typedef struct {
    double slice, time;
    unsigned long long order;
    long long begun;
    int circle, step;
} Crossing;

typedef struct { Crossing *of; size_t count, room; unsigned long long order; } Crossings;

static int is_sooner(const Crossing *one, const Crossing *other)
{
    return one->slice < other->slice || (one->slice == other->slice && one->order < other->order);
}

static int compare_crossings(const void *one, const void *other)
{
    return is_sooner(one, other) ? -1 : is_sooner(other, one);
}

static void sort_crossings(Crossings *waiting)
{
    if (waiting->count > 1)
        qsort(waiting->of, waiting->count, sizeof *waiting->of, compare_crossings);
}

/* A heap: none comes before the one at half its place. */
static int queue(Crossings *waiting, Crossing crossing)
{
    if (waiting->count == waiting->room) {
        size_t room = 2 * waiting->room + 64;
        Crossing *wider = PyMem_Realloc(waiting->of, room * sizeof *wider);
        if (wider == NULL) {
            PyErr_NoMemory();
            return -1;
        }
        waiting->of = wider;
        waiting->room = room;
    }
    crossing.order = waiting->order++;
    size_t at = waiting->count++;
    for (; at > 0 && is_sooner(&crossing, &waiting->of[(at - 1) / 2]); at = (at - 1) / 2)
        waiting->of[at] = waiting->of[(at - 1) / 2];
    waiting->of[at] = crossing;
    return 0;
}

/* Takes off the first of a heap that is not empty. */
static Crossing take_first(Crossings *waiting)
{
    Crossing *of = waiting->of, first = of[0], last = of[--waiting->count];
    size_t at = 0;
    for (size_t next; (next = 2 * at + 1) < waiting->count; at = next) {
        if (next + 1 < waiting->count && is_sooner(&of[next + 1], &of[next]))
            next++;
        if (!is_sooner(&of[next], &last))
            break;
        of[at] = of[next];
    }
    of[at] = last;
    return first;
}

#endif
