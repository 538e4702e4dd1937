/* Three ways to find a first meeting in doubles, to be scored: -DFORMULA=1, 2 (the default) or 3.
 *   1  the quadratic formula, as in textbooks: t = (-b - sqrt(b*b - v2*c)) / v2
 *   2  Lagrange's identity: v2*R*R - (d x v)^2 under the root, and c / (-b + root), where nothing cancels
 *   3  conservative advancement: to fly as long as the gap lasts at the speed, until it is below a tolerance
 * d is the relative place, v the relative velocity, R the sum of radii, b = d.v, c = d.d - R*R, v2 = v.v. Within an arc
 * R is the difference of the radii, and the later zero counts. */
#include <math.h>
#include "vectors.h"

#ifndef FORMULA
#define FORMULA 2
#endif

#define TOLERANCE 1e-10 /* of formula 3: a share of R */
#define MOST_STEPS 1000

/* When a place that flies from d at v comes within R of the origin: 1 and *t, or 0. */
static int meets_round(double dx, double dy, double vx, double vy, double R, double *t) {
  double b = dx * vx + dy * vy, v2 = vx * vx + vy * vy, c = dx * dx + dy * dy - R * R;
  if (!(b < 0)) return 0;
  *t = 0;
  if (c <= 0) return 1; /* they touch, and come nearer */
#if FORMULA == 1
  double root = b * b - v2 * c;
  if (!(root > 0)) return 0;
  *t = (-b - sqrt(root)) / v2;
#elif FORMULA == 2
  double cross = dx * vy - dy * vx, root = v2 * R * R - cross * cross;
  if (!(root > 0)) return 0;
  *t = c / (-b + sqrt(root));
#else
  double speed = sqrt(v2), at = 0;
  for (int k = 0; k < MOST_STEPS; k++) {
    double x = dx + vx * at, y = dy + vy * at, gap = hypot(x, y) - R;
    if (!(x * vx + y * vy < 0)) return 0;
    if (gap <= TOLERANCE * R) { *t = at; return 1; }
    at += gap / speed;
  }
  return 0;
#endif
  return 1;
}

/* When a disc comes to the left side of a line; with `open`, only where its foot then lies between the two points. */
static int meets_side(const double a[5], double x0, double y0, double x1, double y1, double thick, int open, double *t) {
  double ux = x1 - x0, uy = y1 - y0, length = hypot(ux, uy);
  double gap = ux * (a[1] - y0) - uy * (a[0] - x0) - (a[2] + thick) * length, approach = ux * a[4] - uy * a[3];
  if (!(approach < 0) || (open && !(gap >= -(a[2] + thick) * length))) return 0;
  *t = gap <= 0 ? 0 : gap / -approach;
  double foot = ux * (a[0] + a[3] * *t - x0) + uy * (a[1] + a[4] * *t - y0);
  if (open && !(foot > 0 && foot < length * length)) return 0;
  return 1;
}

/* When a place that flies from d at v, in a circle of radius R about the origin or not yet, comes out of it. */
static int leaves_round(double dx, double dy, double vx, double vy, double R, double *t) {
  double b = dx * vx + dy * vy, v2 = vx * vx + vy * vy, c = dx * dx + dy * dy - R * R;
  if (!(R > 0) || !(v2 > 0) || (c > 0 && !(b < 0))) return 0;
  *t = 0;
  if (c >= 0 && b > 0) return 1; /* it touches, and goes on outward */
#if FORMULA == 1
  double root = b * b - v2 * c;
  if (!(root > 0)) return 0;
  *t = (-b + sqrt(root)) / v2;
#elif FORMULA == 2
  double cross = dx * vy - dy * vx, root = v2 * R * R - cross * cross;
  if (!(root > 0)) return 0;
  *t = b > 0 ? -c / (b + sqrt(root)) : (-b + sqrt(root)) / v2;
#else
  double speed = sqrt(v2), at = b < 0 ? -b / v2 : 0; /* from where it is nearest to the middle */
  for (int k = 0; k < MOST_STEPS; k++) {
    double gap = R - hypot(dx + vx * at, dy + vy * at);
    if (k == 0 && gap < 0) return 0;
    if (gap <= TOLERANCE * R) { *t = at; return 1; }
    at += gap / speed;
  }
  return 0;
#endif
  return 1;
}

/* Whether d, seen from the middle of an arc, leads to within it: beyond the chord of the two directions. */
static int faces_arc(const double b[7], double dx, double dy) {
  double px = b[3] - b[0], py = b[4] - b[1], qx = b[5] - b[0], qy = b[6] - b[1], p = hypot(px, py), q = hypot(qx, qy);
  if (!(p > 0)) return 1;
  px /= p, py /= p, qx /= q, qy /= q;
  return (qy - py) * dx + (px - qx) * dy > ((qy - py) * px + (px - qx) * py) * hypot(dx, dy);
}

static int meets_arc(const double a[5], const double b[7], double *t) {
  double dx = a[0] - b[0], dy = a[1] - b[1], at[4], first = INFINITY;
  int found[4] = {0, 0, 0, 0};
  if (hypot(dx, dy) > b[2]) /* its centre is outside */
    found[0] = meets_round(dx, dy, a[3], a[4], b[2] + a[2], &at[0]);
  found[1] = leaves_round(dx, dy, a[3], a[4], b[2] - a[2], &at[1]);
  for (int k = 0; k < 2; k++)
    if (found[k]) found[k] = faces_arc(b, dx + a[3] * at[k], dy + a[4] * at[k]);
  for (int k = 0; k < 2; k++) {
    double px = b[3 + 2 * k] - b[0], py = b[4 + 2 * k] - b[1], p = hypot(px, py), share = p > 0 ? b[2] / p : 0;
    if (p > 0) found[2 + k] = meets_round(dx - share * px, dy - share * py, a[3], a[4], a[2], &at[2 + k]);
  }
  for (int k = 0; k < 4; k++)
    if (found[k] && at[k] < first) first = at[k];
  *t = first;
  return first < INFINITY;
}

int first_meeting(const struct truebreak_vector *v, double *t) {
  const double *a = v->a, *b = v->b;
  if (v->thing == TRUEBREAK_DISC) return meets_round(b[0] - a[0], b[1] - a[1], b[3] - a[3], b[4] - a[4], a[2] + b[2], t);
  if (v->thing == TRUEBREAK_WALL) {
    int left = (b[2] - b[0]) * (a[1] - b[1]) - (b[3] - b[1]) * (a[0] - b[0]) > 0;
    return left ? meets_side(a, b[0], b[1], b[2], b[3], 0, 0, t) : meets_side(a, b[2], b[3], b[0], b[1], 0, 0, t);
  }
  if (v->thing == TRUEBREAK_ARC) return meets_arc(a, b, t);
  double at[4], first = INFINITY;
  int found[4] = {
      meets_side(a, b[0], b[1], b[2], b[3], b[4], 1, &at[0]),
      meets_side(a, b[2], b[3], b[0], b[1], b[4], 1, &at[1]),
      meets_round(b[0] - a[0], b[1] - a[1], -a[3], -a[4], a[2] + b[4], &at[2]),
      meets_round(b[2] - a[0], b[3] - a[1], -a[3], -a[4], a[2] + b[4], &at[3]),
  };
  for (int k = 0; k < 4; k++)
    if (found[k] && at[k] < first) first = at[k];
  *t = first;
  return first < INFINITY;
}
