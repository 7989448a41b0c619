/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Lobes widened by covariances of slopes, lane by lane: shade_params_widen in single precision,
 * without trigonometry.
 */
#include "../src/slope_map.h"

/* `count`: SLOPE_BLOCK at most. Returns status bits. */
static unsigned kernel_widen(const widen_block *b, size_t count) {
  const float unit = b->exponents ? 1 : 2, choice_y = b->groove_y, automatic = b->groove_auto;
  const float least = b->exponents ? 1e-12F : 1e-4F, most = b->exponents ? 1e6F : 10;
  const float *restrict in_nx = b->n[0], *restrict in_ny = b->n[1], *restrict in_nz = b->n[2];
  const float *restrict in_xx = b->covariance[0], *restrict in_xy = b->covariance[1],
                        *restrict in_yy = b->covariance[2];
  const float *restrict base_x = b->base[0], *restrict base_y = b->base[1];
  float *restrict to_x = b->width[0], *restrict to_y = b->width[1];
  float *restrict groove_x = b->groove[0], *restrict groove_y = b->groove[1];
  const float exponents = b->exponents ? 1 : 0, alphas = 1 - exponents;
  const float narrowed = b->narrowed, blunted = b->blunted;
  int bad = 0, clamped = 0;
#pragma omp simd reduction(| : bad, clamped)
  for (size_t i = 0; i < count; i++) {
    /* the normal; z for one that is none, or lies flat */
    float longest = fabsf(in_nx[i]) > fabsf(in_ny[i]) ? fabsf(in_nx[i]) : fabsf(in_ny[i]);
    longest = longest > fabsf(in_nz[i]) ? longest : fabsf(in_nz[i]);
    const float shrink = 1 / (longest > 1e-30F ? longest : 1e-30F);
    const float gx = in_nx[i] * shrink, gy = in_ny[i] * shrink, gz = in_nz[i] * shrink;
    const float length2 = gx * gx + gy * gy + gz * gz, inverse = 1 / sqrtf(length2 + 1e-37F);
    const int upright = (length2 > 0.5F) & (length2 < 4) & (gz * inverse > 1e-4F);
    const float n_x = gx * inverse, n_y = gy * inverse, n_z = gz * inverse;
    const float x = upright ? n_x : 0, y = upright ? n_y : 0, z = upright ? n_z : 1;

    /* the covariance; the nearest that has no negative direction */
    float xx = in_xx[i], xy = in_xy[i], yy = in_yy[i];
    const int finite = (fabsf(xx) < 3.4e38F) & (fabsf(xy) < 3.4e38F) & (fabsf(yy) < 3.4e38F);
    xx = finite ? xx : 0;
    xy = finite ? xy : 0;
    yy = finite ? yy : 0;
    float size = fabsf(xx) > fabsf(xy) ? fabsf(xx) : fabsf(xy);
    size = size > fabsf(yy) ? size : fabsf(yy);
    const float limit = 1e12F, over = limit / (size > limit ? size : limit);
    xx *= over;
    xy *= over;
    yy *= over;
    const float mean = 0.5F * (xx + yy), gap = 0.5F * (xx - yy), root = sqrtf(gap * gap + xy * xy);
    const float low = mean - root, high = mean + root;
    const int indefinite = low < -1e-6F * fabsf(high);
    const float keep = high > 0 ? 0.5F * high : 0, per = 1 / (root + 1e-37F);
    const float kxx = keep * (1 + gap * per), kyy = keep * (1 - gap * per), kxy = keep * xy * per;
    xx = indefinite ? kxx : xx;
    xy = indefinite ? kxy : xy;
    yy = indefinite ? kyy : yy;
    int wrong = upright ? 0 : 1;
    wrong = finite ? wrong : 1;
    wrong = indefinite ? 1 : wrong;
    bad |= wrong;

    /* squared widths of the lobe */
    float bx = base_x[i], by = base_y[i];
    const int within = (bx >= least) & (bx <= most) & (by >= least) & (by <= most);
    bx = bx > least ? bx : least;
    by = by > least ? by : least;
    bx = bx < most ? bx : most;
    by = by < most ? by : most;
    const float product = 1 / (bx * by), ex = by * product, ey = bx * product, ax = bx * bx,
                ay = by * by;
    /* blends, not choices, by what all lanes share: those keep gcc from vectors */
    const float wx = exponents * ex + alphas * ax, wy = exponents * ey + alphas * ay;
    const int by_width = wy < wx;
    const float across = by_width ? automatic : choice_y;

    /* the covariance in the tangent plane of n, by rows along the carried axes */
    const int along_y = across > 0;
    const float aside = along_y ? y : x, m = sqrtf(aside * aside + z * z), zm = z / m;
    const float far = m * z, near = z * zm, askew = -x * y * zm;
    /* (far, askew), (0, near) with grooves along y; (near, 0), (askew, far) along x */
    /* as the lobe's own width narrows them: shade_params_widen says why */
    const float tall_x = 1 + narrowed * wx, tall_y = 1 + narrowed * wy,
                squash = 1 / (tall_x * tall_y), nx = tall_y * squash, ny = tall_x * squash;
    const float ja = nx * (along_y ? far : near), jb = nx * (along_y ? askew : 0),
                jc = ny * (along_y ? 0 : askew), jd = ny * (along_y ? near : far);
    const float sxx = ja * ja * xx + 2 * ja * jb * xy + jb * jb * yy;
    const float sxy = ja * jc * xx + (ja * jd + jb * jc) * xy + jb * jd * yy;
    const float syy = jc * jc * xx + 2 * jc * jd * xy + jd * jd * yy;

    /* by the determinant, whose terms are all positive, but for what double precision subtracts */
    const double exact = (double)xx * (double)yy - (double)xy * (double)xy;
    const float spread = exact > 0 ? (float)exact : 0, stretch = unit * (ja * jd - jb * jc);
    const float slopes = stretch * (stretch * spread), own = wx * wy;
    /* all times the determinant of both together, until the end: no division is waited for */
    const float whole = own + slopes + unit * (wx * syy + wy * sxx), per_whole = 1 / whole;
    const float of_own = whole + blunted * slopes, of_slopes = whole + blunted * own;
    const float own_x = of_own * wx, own_y = of_own * wy, added = of_slopes * unit;

    /* the principal axis nearest to x becomes x */
    const float vxx = own_x + added * sxx, vxy = added * sxy, vyy = own_y + added * syy;
    const float half = 0.5F * (vxx - vyy),
                wide = fabsf(half) > fabsf(vxy) ? fabsf(half) : fabsf(vxy);
    const float scale = wide + 1e-37F; /* squares of what is left do not vanish */
    const float per_scale = 1 / scale, gap2 = half * per_scale, turn2 = vxy * per_scale;
    const float r2 = sqrtf(gap2 * gap2 + turn2 * turn2);
    const float long_half = r2 * scale, r = r2 + 1e-37F;
    const int none = !(r2 > 0.5F);
    float cs = sqrtf(0.5F * (1 + fabsf(gap2) / r));
    cs = none ? 1 : cs;
    float sn = 0.5F * turn2 / (r * cs);
    sn = half < 0 ? -sn : sn;
    sn = none ? 0 : sn;
    const float middle = 0.5F * (vxx + vyy);
    const float larger = middle + long_half, per_larger = 1 / larger, turned = of_slopes * stretch;
    const float smaller = own_x * (own_y * per_larger) +
                          added * (own_x * (syy * per_larger) + own_y * (sxx * per_larger)) +
                          turned * (turned * (spread * per_larger));
    const float widest = per_whole * (half < 0 ? smaller : larger),
                other = per_whole * (half < 0 ? larger : smaller);
    const float rx = sqrtf(widest), ry = sqrtf(other), both = 1 / (widest * other + 1e-37F),
                qx = other * both, qy = widest * both;
    float px = exponents * qx + alphas * rx, py = exponents * qy + alphas * ry;
    const float floor = alphas * 1e-4F;
    const int fits = (px >= floor) & (px <= most) & (py >= floor) & (py <= most);
    px = px > floor ? px : floor;
    py = py > floor ? py : floor;
    px = px < most ? px : most;
    py = py < most ? py : most;
    int cut = fits ? 0 : 1;
    cut = within ? cut : 1;
    clamped |= cut;
    to_x[i] = px;
    to_y[i] = py;
    groove_x[i] = cs;
    groove_y[i] = sn;
  }
  return (bad ? SHADE_BAD_INPUT : 0u) | (clamped ? SHADE_CLAMPED_PARAMETER : 0u);
}
