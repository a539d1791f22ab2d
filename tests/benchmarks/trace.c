/* The physical limit: what this machine needs for the trace when nothing else is asked of it.

   The arithmetic of the library (to the vertex plane, to the conic, Newton's steps on an asphere, Snell's law) without
   statuses, checks and general frames. Blocks of BLOCK rays stay in the first-level cache while all surfaces pass
   over them; blocks are shared out over threads. `limit.py` compiles it once for each type REAL of number.

   A ray is x, y, z in mm in the frame of the vertex before, and the direction cosines l, m, n. */

#include <math.h>
#include <stdint.h>
#include <string.h>

#define EACH _Pragma("omp simd") for (int i = 0; i < BLOCK; i++)
#define MOST_SURFACES 64
#define NEWTON_STEPS 3

typedef struct {
    REAL curvature, conic, gap;           /* 1/mm; pure number; mm from the vertex before to this one */
    REAL mu, kappa;                       /* n1 / n2; 1 - mu^2, formed in double */
    REAL fourth, sixth, eighth;           /* of r^4, r^6, r^8 */
    REAL aspheric;                        /* 0: a sphere */
} Surface;

typedef struct {
    REAL x[BLOCK], y[BLOCK], z[BLOCK], l[BLOCK], m[BLOCK], n[BLOCK];
} Rays;

/* What the way back needs to know of a crossing: where it is, the directions, 1 / E, 1 / root of Snell's law. */
typedef struct {
    REAL x[BLOCK], y[BLOCK], z[BLOCK], l[BLOCK], m[BLOCK], n[BLOCK], over[BLOCK], kick[BLOCK], root_over[BLOCK];
} Crossing;

static REAL root(REAL a) { return sizeof(REAL) == 8 ? (REAL)sqrt(a) : (REAL)sqrtf((float)a); }

static void sphere(const Surface *s, Rays *restrict r) {
    const REAL c = s->curvature, gap = s->gap, mu = s->mu, kappa = s->kappa, mu2 = mu * mu;
    EACH {
        REAL l = r->l[i], m = r->m[i], n = r->n[i];
        REAL to_plane = (gap - r->z[i]) / n;
        REAL x = r->x[i] + to_plane * l, y = r->y[i] + to_plane * m;
        REAL f = c * (x * x + y * y), g = n - c * (x * l + y * m);
        REAL cosine = root(g * g - c * f);
        REAL t = f / (g + cosine);
        x += t * l, y += t * m;
        REAL z = t * n;
        REAL kick = kappa / (mu * cosine + root(mu2 * cosine * cosine + kappa));
        r->x[i] = x, r->y[i] = y, r->z[i] = z;
        r->l[i] = mu * l - kick * c * x, r->m[i] = mu * m - kick * c * y, r->n[i] = mu * n + kick * (1 - c * z);
    }
}

static void asphere(const Surface *s, Rays *restrict r) {
    const REAL c = s->curvature, k = s->conic, gap = s->gap, mu = s->mu, kappa = s->kappa;
    const REAL a4 = s->fourth, a6 = s->sixth, a8 = s->eighth;
    EACH {
        REAL l = r->l[i], m = r->m[i], n = r->n[i];
        REAL to_plane = (gap - r->z[i]) / n;
        REAL x = r->x[i] + to_plane * l, y = r->y[i] + to_plane * m;
        REAL f = c * (x * x + y * y), g = n - c * (x * l + y * m);
        REAL t = f / (g + root(g * g - c * (1 + k * n * n) * f));
        REAL px, py, slope;
        for (int step = 0; step < NEWTON_STEPS; step++) {
            px = x + t * l, py = y + t * m;
            REAL r2 = px * px + py * py, w = root(1 - (1 + k) * c * c * r2), both = 1 / (w * (1 + w));
            REAL sag = r2 * (c * w * both + r2 * (a4 + r2 * (a6 + r2 * a8)));
            slope = c * (1 + w) * both + r2 * (4 * a4 + r2 * (6 * a6 + r2 * 8 * a8));
            t -= (t * n - sag) / (n - slope * (px * l + py * m));
        }
        x += t * l, y += t * m;
        REAL r2 = x * x + y * y;
        slope = c / root(1 - (1 + k) * c * c * r2) + r2 * (4 * a4 + r2 * (6 * a6 + r2 * 8 * a8));
        REAL cosine = n - slope * (x * l + y * m), square = 1 + slope * slope * r2;
        REAL kick = kappa / (mu * cosine + root(mu * mu * cosine * cosine + kappa * square));
        r->x[i] = x, r->y[i] = y, r->z[i] = t * n;
        r->l[i] = mu * l - kick * slope * x, r->m[i] = mu * m - kick * slope * y, r->n[i] = mu * n + kick;
    }
}

/* Through the surfaces, and on to the image plane. */
static void through(const Surface *s, int surfaces, REAL last, Rays *restrict r) {
    for (int j = 0; j < surfaces; j++) {
        if (s[j].aspheric)
            asphere(s + j, r);
        else
            sphere(s + j, r);
    }
    EACH {
        REAL t = (last - r->z[i]) / r->n[i];
        r->x[i] += t * r->l[i], r->y[i] += t * r->m[i], r->z[i] = 0;
    }
}

/* in, out: x, y, z, l, m, n, each (count,); count is at least BLOCK. The last block begins earlier, so that it is full. */
void trace(const Surface *s, int surfaces, REAL last, int64_t count, REAL *const *in, REAL *const *out) {
    int64_t blocks = (count + BLOCK - 1) / BLOCK;
#pragma omp parallel for schedule(dynamic, 128)
    for (int64_t b = 0; b < blocks; b++) {
        int64_t start = b * BLOCK < count - BLOCK ? b * BLOCK : count - BLOCK;
        Rays r;
        REAL *part[6] = {r.x, r.y, r.z, r.l, r.m, r.n};
        for (int a = 0; a < 6; a++)
            memcpy(part[a], in[a] + start, sizeof r.x);
        through(s, surfaces, last, &r);
        for (int a = 0; a < 6; a++)
            memcpy(out[a] + start, part[a], sizeof r.x);
    }
}

/* Rays of a field in y through the points px, py of a pupil: x = radius px, y = radius py + shift on the vertex plane. */
static void launch(const REAL *px, const REAL *py, int64_t start, const REAL *field, Rays *restrict r) {
    EACH {
        r->x[i] = field[0] * px[start + i], r->y[i] = field[0] * py[start + i] + field[1], r->z[i] = 0;
        r->l[i] = 0, r->m[i] = field[2], r->n[i] = field[3];
    }
}

/* Sums over the rays of x - x0, y - y0 and the square of both; nothing is written for a ray.
   field: radius, shift (mm), m, n.      about: x0, y0. */
void sums(const Surface *s, int surfaces, REAL last, int64_t count, const REAL *px, const REAL *py, const REAL *field,
          const REAL *about, double *found) {
    int64_t blocks = (count + BLOCK - 1) / BLOCK;
    double all_x = 0, all_y = 0, all_square = 0;
#pragma omp parallel for schedule(dynamic, 128) reduction(+ : all_x, all_y, all_square)
    for (int64_t b = 0; b < blocks; b++) {
        int64_t start = b * BLOCK < count - BLOCK ? b * BLOCK : count - BLOCK;
        int known = (int)(b * BLOCK - start);
        Rays r;
        REAL sum_x = 0, sum_y = 0, sum_square = 0;
        launch(px, py, start, field, &r);
        through(s, surfaces, last, &r);
#pragma omp simd reduction(+ : sum_x, sum_y, sum_square)
        for (int i = 0; i < BLOCK; i++) {
            REAL dx = i < known ? 0 : r.x[i] - about[0], dy = i < known ? 0 : r.y[i] - about[1];
            sum_x += dx, sum_y += dy, sum_square += dx * dx + dy * dy;
        }
        all_x += sum_x, all_y += sum_y, all_square += sum_square;
    }
    found[0] = all_x, found[1] = all_y, found[2] = all_square;
}

/* As `sphere`, and remembers. */
static void remembered(const Surface *s, Rays *restrict r, Crossing *restrict w) {
    const REAL c = s->curvature, gap = s->gap, mu = s->mu, kappa = s->kappa, mu2 = mu * mu;
    EACH {
        REAL l = r->l[i], m = r->m[i], n = r->n[i];
        REAL to_plane = (gap - r->z[i]) / n;
        REAL x = r->x[i] + to_plane * l, y = r->y[i] + to_plane * m;
        REAL f = c * (x * x + y * y), g = n - c * (x * l + y * m);
        REAL cosine = root(g * g - c * f), over = 1 / cosine;
        REAL t = f / (g + cosine);
        x += t * l, y += t * m;
        REAL z = t * n, second = root(mu2 * cosine * cosine + kappa);
        REAL kick = kappa / (mu * cosine + second);
        w->x[i] = x, w->y[i] = y, w->z[i] = z, w->l[i] = l, w->m[i] = m, w->n[i] = n, w->over[i] = over;
        w->kick[i] = kick, w->root_over[i] = mu * kick / second;
        r->x[i] = x, r->y[i] = y, r->z[i] = z;
        r->l[i] = mu * l - kick * c * x, r->m[i] = mu * m - kick * c * y, r->n[i] = mu * n + kick * (1 - c * z);
    }
}

/* Back over one sphere: `a` is the derivative of the merit by the ray behind it, and becomes that by the ray before.

   Behind: d2 = mu d1 + k N, N = (-c x, -c y, 1 - c z), k(E), dk / dE = -mu k / root (`root_over`), E = N . d1.
   The point p = o + t d1 on the sphere: N . (do + t dd1 + d1 dt) = (p . p) dc / 2, and p . p c = 2 z. Where o lies on
   the ray does not matter: it is taken at the crossing before, whose z is that in this frame. */
static REAL back(const Surface *s, const Crossing *restrict w, const REAL *restrict z_before, Rays *restrict a) {
    const REAL c = s->curvature, gap = s->gap, mu = s->mu;
    REAL by_curvature = 0;
#pragma omp simd reduction(+ : by_curvature)
    for (int i = 0; i < BLOCK; i++) {
        REAL x = w->x[i], y = w->y[i], z = w->z[i], l = w->l[i], m = w->m[i], n = w->n[i];
        REAL nx = -c * x, ny = -c * y, nz = 1 - c * z, kick = w->kick[i];
        REAL al = a->l[i], am = a->m[i], an = a->n[i];
        REAL by_kick = al * nx + am * ny + an * nz, by_cosine = -by_kick * w->root_over[i];
        REAL bx = kick * al + by_cosine * l, by = kick * am + by_cosine * m, bz = kick * an + by_cosine * n;
        REAL ax = a->x[i] - c * bx, ay = a->y[i] - c * by, az = a->z[i] - c * bz;
        al = mu * al + by_cosine * nx, am = mu * am + by_cosine * ny, an = mu * an + by_cosine * nz;
        REAL by_t = (ax * l + ay * m + az * n) * w->over[i];
        by_curvature += by_t * (x * x + y * y + z * z) / 2 - (bx * x + by * y + bz * z);
        ax -= by_t * nx, ay -= by_t * ny, az -= by_t * nz;
        REAL t = (z + gap - z_before[i]) / n;
        a->x[i] = ax, a->y[i] = ay, a->z[i] = az;
        a->l[i] = al + t * ax, a->m[i] = am + t * ay, a->n[i] = an + t * az;
    }
    return by_curvature;
}

/* The sum over the rays of (x - x0)^2 + (y - y0)^2, and its derivatives by the curvatures (spheres) and, last, by the
   shift of the rays in y at launch.   Arguments as for `sums`; found: 1 + surfaces + 1 numbers. */
void slopes(const Surface *s, int surfaces, REAL last, int64_t count, const REAL *px, const REAL *py,
            const REAL *field, const REAL *about, double *found) {
    int64_t blocks = (count + BLOCK - 1) / BLOCK;
    int size = surfaces + 2;
    memset(found, 0, size * sizeof(double));
#pragma omp parallel for schedule(dynamic, 64) reduction(+ : found[ : size])
    for (int64_t b = 0; b < blocks; b++) {
        int64_t start = b * BLOCK < count - BLOCK ? b * BLOCK : count - BLOCK;
        int known = (int)(b * BLOCK - start);
        static const REAL on_plane[BLOCK];
        Crossing way[MOST_SURFACES];
        Rays r, a;
        REAL sum = 0, shift = 0;
        launch(px, py, start, field, &r);
        for (int j = 0; j < surfaces; j++)
            remembered(s + j, &r, way + j);
#pragma omp simd reduction(+ : sum)
        for (int i = 0; i < BLOCK; i++) {
            REAL over = 1 / r.n[i], t = (last - r.z[i]) * over;
            REAL dx = i < known ? 0 : r.x[i] + t * r.l[i] - about[0], dy = i < known ? 0 : r.y[i] + t * r.m[i] - about[1];
            sum += dx * dx + dy * dy;
            REAL ax = 2 * dx, ay = 2 * dy, az = -(ax * r.l[i] + ay * r.m[i]) * over;
            a.x[i] = ax, a.y[i] = ay, a.z[i] = az, a.l[i] = t * ax, a.m[i] = t * ay, a.n[i] = t * az;
        }
        found[0] += sum;
        for (int j = surfaces - 1; j >= 0; j--)
            found[1 + j] += back(s + j, way + j, j ? way[j - 1].z : on_plane, &a);
#pragma omp simd reduction(+ : shift)
        for (int i = 0; i < BLOCK; i++)
            shift += a.y[i];
        found[1 + surfaces] += shift;
    }
}
