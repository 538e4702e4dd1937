/* Scores a program's first meetings against certified ones: cc -O2 -o score score.c formulas.c -lm && ./score
 * Yours: in place of formulas.c, a file that defines first_meeting. From `truebreak vectors`; vectors.h beside it. */
#include <math.h>
#include <stdio.h>
#include <time.h>
#include "vectors.h"

/* Whether disc v->a meets v->b; if so, *t becomes the time from the start. */
int first_meeting(const struct truebreak_vector *v, double *t);

struct score { int n, meets, false_hits, missed; double worst; int worst_at; };

/* How far a time is off, as a share of the certified one; of a meeting at time 0, in units of the smallest double. */
static double error(const struct truebreak_vector *v, double t) {
  double off = fabs((t - v->time) - v->rest);
  if (t == v->time) off = fabs(v->rest);
  return v->time > 0 ? off / v->time : off;
}

static void print(const char *thing, const char *kind, const struct score *s) {
  printf("%-8s %-10s %7d %7d %12d %7d  ", thing, kind, s->n, s->meets, s->false_hits, s->missed);
  if (s->worst_at >= 0) printf("%.2e (vector %d)\n", s->worst, s->worst_at);
  else printf("-\n");
}

static void add(struct score *sum, const struct score *s) {
  sum->n += s->n;
  sum->meets += s->meets;
  sum->false_hits += s->false_hits;
  sum->missed += s->missed;
  if (s->worst_at >= 0 && s->worst >= sum->worst) sum->worst = s->worst, sum->worst_at = s->worst_at;
}

int main(void) {
  static struct score all[TRUEBREAK_THINGS][TRUEBREAK_KINDS];
  struct score sum = {0, 0, 0, 0, 0.0, -1};
  for (int i = 0; i < TRUEBREAK_THINGS; i++)
    for (int k = 0; k < TRUEBREAK_KINDS; k++) all[i][k].worst_at = -1;
  for (int k = 0; k < TRUEBREAK_VECTORS; k++) {
    const struct truebreak_vector *v = &truebreak_vectors[k];
    struct score *s = &all[v->thing][v->kind];
    double t = 0.0;
    int meets = first_meeting(v, &t);
    s->n++;
    s->meets += v->meets;
    s->false_hits += meets && !v->meets;
    s->missed += !meets && v->meets;
    if (meets && v->meets) {
      double off = error(v, t);
      if (!(off < s->worst) || s->worst_at < 0) s->worst = off, s->worst_at = k;
    }
  }
  printf("thing    kind       vectors   meet  false hits  missed  worst error of a time, as a share\n");
  for (int i = 0; i < TRUEBREAK_THINGS; i++)
    for (int k = 0; k < TRUEBREAK_KINDS; k++)
      if (all[i][k].n) {
        print(truebreak_things[i], truebreak_kinds[k], &all[i][k]);
        add(&sum, &all[i][k]);
      }
  print("all", "", &sum);
  volatile double keep = 0.0;
  double queries = 0.0;
  clock_t begun = clock();
  do {
    for (int k = 0; k < TRUEBREAK_VECTORS; k++) {
      double t = 0.0;
      if (first_meeting(&truebreak_vectors[k], &t)) keep = keep + t;
    }
    queries += TRUEBREAK_VECTORS;
  } while (clock() - begun < CLOCKS_PER_SEC / 4);
  printf("%.1f ns a query\n", 1e9 * (double)(clock() - begun) / CLOCKS_PER_SEC / queries);
  return sum.false_hits || sum.missed;
}
