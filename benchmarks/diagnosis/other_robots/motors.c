/* One motor with its load, and the two wheels of a robot, integrated in small steps; compiled.py calls them.
 *
 * All quantities are at the wheel shaft. A variant is a row of parameters in the order of the
 * enumerations (the same lists stand in steps/bench.py and drives/wheels.py). Every trial starts at rest.
 * The integrators use the midpoint rule. Sticking and contact are decided at every small step. */
#include <math.h>
#include <stdlib.h>

enum { R, K, B, TC, J, EXTRA, VS, ASYM, DROP, RS, DELAY, LAG, LIMIT, GAP, FJ, FF, FILT, WLATE, RIPA, RIPN, RIPP,
       VSUP, IND, SPRING, SLEW, TRIP, TRIPT, ECC, ECCP, UMIN, RHEAT, MHEAT, FLEXK, FLEXD, CLOCK, IFILT, TCRAMP, NP };

static double sgn(double x) { return (x > 0) - (x < 0); }

/* size of the friction torque at speed w for motion in direction s, at the wheel angle */
static double friction(const double *p, double tc, double w, double s, double angle) {
    double f = tc * (1 - p[ASYM] * s) + p[B] * fabs(w);
    if (p[EXTRA] != 0) f += p[EXTRA] * exp(-(w / p[VS]) * (w / p[VS]));
    if (p[RIPA] != 0) f += p[RIPA] * cos(p[RIPN] * angle + p[RIPP]);
    return f;
}

static double steady_current(const double *p, double r, double k, double u, double w) {
    double e = u - k * w, duty = u / p[VSUP];
    double i = sgn(e) * fmax(fabs(e) - p[DROP], 0) / (r + p[RS] * duty * duty);
    if (i > p[LIMIT]) i = p[LIMIT];
    if (i < -p[LIMIT]) i = -p[LIMIT];
    return i;
}

/* speed after h of one body of inertia j with driving torque a + b w and a share of the friction */
static double advance(const double *p, double tc, double j, double share, double a, double b, double w, double h,
                   double angle) {
    double s = sgn(w), half, next;
    if (s == 0) {
        s = sgn(a);
        if (s == 0 || fabs(a) <= share * friction(p, tc, 0, s, angle)) return 0;
    }
    half = w + 0.5 * h / j * (a + b * w - s * share * friction(p, tc, w, s, angle));
    if (half * s < 0) half = 0;
    next = w + h / j * (a + b * half - s * share * friction(p, tc, half, s, angle));
    if (next * s < 0) {  /* it stops within the step; the rest of the step begins at rest */
        double rest = h * next / (next - w);
        s = sgn(a);
        if (s == 0 || fabs(a) <= share * friction(p, tc, 0, s, angle)) return 0;
        next = rest / j * (a - s * share * friction(p, tc, 0, s, angle));
    }
    return next;
}

static double held(const double *u, int n, double dt, double t) {
    int row = (int)ceil(t / dt - 1e-9) - 1;
    if (row < 0) return 0;
    if (row >= n) row = n - 1;
    return u[row];
}

void simulate_trials(int variants, int trials, int samples, int sub, double dt, const double *commands,
                     const double *starts, double session, const double *params, double *out_i, double *out_w) {
    double h = dt / sub, *past = malloc(sizeof(double) * (samples * sub + 1));
    for (int v = 0; v < variants; v++) for (int q = 0; q < trials; q++) {
        const double *p = params + v * NP, *u = commands + q * samples;
        double wm = 0, wl = 0, phi = 0, angle = 0, uf = 0, i = 0, seen = 0, iseen = 0, off = 0;
        double jm = p[J] * p[FJ], jl = p[J] * (1 - p[FJ]);
        int contact = 0;
        past[0] = 0;
        for (int n = 0; n < samples * sub; n++) {
            double t = n * h, late = p[DELAY], age = (starts[q] + t) / session;
            double r = p[R] * (1 + p[RHEAT] * age), k = p[K] * (1 - p[MHEAT] * age);
            double tc = p[TC] * (1 + p[TCRAMP] * age);
            /* mean commanded voltage over the small step */
            double a = held(u, samples, dt, t - late + 1e-7 * dt), b = held(u, samples, dt, t + h - late), ua = b;
            if (a != b) {
                double edge = ceil((t - late) / dt - 1e-9) * dt, part = (edge - (t - late)) / h;
                if (part > 1) part = 1;
                if (part < 0) part = 0;
                ua = part * a + (1 - part) * b;
            }
            if (fabs(ua) < p[UMIN]) ua = 0;
            if (fabs(b) < p[UMIN]) b = 0;
            double un = ua, before = uf;
            if (p[LAG] > 0) {
                uf += (ua - uf) * -expm1(-h / p[LAG]);
                un = 0.5 * (uf + before);
                b = uf;
            } else if (p[SLEW] > 0) {
                double most = p[SLEW] * h, d = ua - uf;
                uf += d > most ? most : d < -most ? -most : d;
                un = 0.5 * (uf + before);
                b = uf;
            }
            if (p[TRIP] > 0) {
                if (off > 0) { off -= h; un = 0; b = 0; }
                else if (fabs(steady_current(p, r, k, un, wm)) > p[TRIP]) off = p[TRIPT];
            }
            /* driving torque as a + b w about the present speed */
            double lin, con;
            if (p[IND] > 0) {
                double steady = steady_current(p, r, k, un, wm), mean;
                mean = steady + (i - steady) * p[IND] / r / h * -expm1(-r * h / p[IND]);
                i = steady + (i - steady) * exp(-r * h / p[IND]);
                con = k * mean; lin = 0;
            } else {
                double i0 = steady_current(p, r, k, un, wm), d = 1e-4 * (fabs(wm) + 0.1);
                double i1 = steady_current(p, r, k, un, wm + d);
                lin = k * (i1 - i0) / d;
                con = k * i0 - lin * wm;
            }
            con -= p[SPRING] * angle;
            double w0 = wm;
            if (p[FLEXK] > 0) {
                double twist = p[FLEXK] * phi + p[FLEXD] * (wm - wl);
                double nm = advance(p, tc, jm, p[FF], con - twist, lin, wm, h, angle);
                double nl = advance(p, tc, jl, 1 - p[FF], twist, 0, wl, h, angle);
                phi += h * (0.5 * (wm + nm) - 0.5 * (wl + nl));
                wm = nm; wl = nl;
            } else if (p[GAP] > 0) {
                double drive = con + lin * wm;
                if (contact) {
                    if (wm == 0) {
                        double stuck = p[FF] * friction(p, tc, 0, sgn(drive), angle);
                        if (sgn(drive) == -contact && fabs(drive) > stuck) contact = 0;
                    } else {
                        double s = sgn(wm);
                        double acc = (drive - s * friction(p, tc, wm, s, angle)) / p[J];
                        double push = jl * acc + s * (1 - p[FF]) * friction(p, tc, wm, s, angle);
                        if (push * contact < 0) contact = 0;
                    }
                }
                if (contact) {
                    wm = wl = advance(p, tc, p[J], 1, con, lin, wm, h, angle);
                } else {
                    double nm = advance(p, tc, jm, p[FF], con, lin, wm, h, angle);
                    double nl = advance(p, tc, jl, 1 - p[FF], 0, 0, wl, h, angle);
                    phi += 0.5 * h * (wm + nm - wl - nl);
                    wm = nm; wl = nl;
                    if (fabs(phi) >= 0.5 * p[GAP]) {
                        contact = (int)sgn(phi);
                        phi = 0.5 * p[GAP] * contact;
                        wm = wl = (jm * wm + jl * wl) / p[J];
                    }
                }
            } else {
                wm = wl = advance(p, tc, p[J], 1, con, lin, wm, h, angle);
            }
            angle += 0.5 * h * (w0 + wm);
            double read = wm * (1 + p[ECC] * cos(angle + p[ECCP]));
            if (p[FILT] > 0) {
                seen += (0.5 * (past[n] + read) - seen) * -expm1(-h / p[FILT]);
                past[n + 1] = read;
            } else {
                seen = read;
                past[n + 1] = read;
            }
            double now = p[IND] > 0 ? i : steady_current(p, r, k, b, wm);
            iseen = p[IFILT] > 0 ? iseen + (now - iseen) * -expm1(-h / p[IFILT]) : now;
            if ((n + 1) % sub == 0) {
                int row = (n + 1) / sub - 1;
                double shown = seen, back = p[WLATE] + p[CLOCK] * (t + h);
                if (back > 0) {
                    double at = (t + h - back) / h;
                    int c = (int)floor(at);
                    shown = at <= 0 ? 0 : past[c] + (at - c) * (past[c + 1] - past[c]);
                }
                out_i[(v * trials + q) * samples + row] = iseen;
                out_w[(v * trials + q) * samples + row] = shown;
            }
        }
    }
    free(past);
}

/* The two wheels of a robot: rows first to last - 1 of one trial that began at row
 * start. Voltages hold from row to row. push: signed outside torque; drag: extra friction torque.
 * state: speeds and angles of both wheels per variant, updated. out: angles at the rows' ends. */
enum { WR, WK, WB, WTC, WJ, WMIS, WDROP, WRS, WDECL, WDELAY, WVS, WTURN, WUMIN, WHEAT, NW };

void advance_wheels(int variants, int first, int last, int start, int total, int sub, double dt, const double *u,
                    const double *session, const double *push, const double *drag, const double *params, double *state,
                    double *out) {
    double h = dt / sub;
    for (int v = 0; v < variants; v++) {
        const double *p = params + v * NW;
        double *w = state + v * 4, *angle = w + 2;
        for (int row = first; row < last; row++) {
            double r = p[WR] * (1 + p[WHEAT] * session[row]);
            for (int n = 0; n < sub; n++) {
                double ua[2], i[2] = {0, 0}, k[2] = {p[WK] * (1 + p[WMIS] / 2), p[WK] * (1 - p[WMIS] / 2)}, left = 1;
                for (int c = 0; c < 2; c++) {
                    double t = (row - start + (n + 0.5) / sub) * dt - p[WDELAY];
                    /* share of the small step after the last change of the command */
                    int b = (int)floor((t + 0.5 * h) / dt - 1e-9), a = (int)floor((t - 0.5 * h) / dt + 1e-9);
                    double ub = b < 0 ? 0 : u[c * total + start + b], uu = a < 0 ? 0 : u[c * total + start + a];
                    double part = a == b ? 1 : (t + 0.5 * h - b * dt) / h;
                    ua[c] = part * ub + (1 - part) * uu;
                    ua[c] *= 1 - p[WDECL] * session[row] / 60;
                    if (fabs(ua[c]) < p[WUMIN]) ua[c] = 0;
                }
                double before[2] = {w[0], w[1]};
                for (int stage = 0; stage < 2; stage++) {
                    double mid[2];
                    for (int c = 0; c < 2; c++) mid[c] = stage ? 0.5 * (w[c] + before[c]) : before[c];
                    for (int turn = 0; turn < (p[WRS] > 0 ? 6 : 1); turn++) {
                        double input = 0;
                        for (int c = 0; c < 2; c++) {
                            double e = ua[c] * left - k[c] * mid[c];
                            i[c] = sgn(e) * fmax(fabs(e) - p[WDROP], 0) / r;
                            input += fabs(ua[c] / p[WVS]) * fabs(i[c]);
                        }
                        left = fmax(0, 1 - p[WRS] * input / p[WVS]);
                    }
                    double turning = 1 + p[WTURN] * fabs(before[1] - before[0]);
                    for (int c = 0; c < 2; c++) {
                        double tc = p[WTC] * turning + drag[c * total + row], a = k[c] * i[c] + push[c * total + row];
                        double s = sgn(before[c]);
                        if (s == 0) { s = sgn(a); if (fabs(a) <= tc) s = 0; }
                        double next = s == 0 ? 0 : before[c] + h / p[WJ] * (a - p[WB] * mid[c] - s * tc);
                        if (next * s < 0) {
                            double rest = h * next / (next - before[c]);
                            double a0 = k[c] * (i[c] + k[c] * mid[c] / r) + push[c * total + row];
                            s = sgn(a0);
                            next = fabs(a0) <= tc ? 0 : rest / p[WJ] * (a0 - s * tc);
                        }
                        w[c] = next;
                    }
                }
                for (int c = 0; c < 2; c++) angle[c] += 0.5 * h * (before[c] + w[c]);
            }
            out[(v * 2) * total + row] = angle[0];
            out[(v * 2 + 1) * total + row] = angle[1];
        }
    }
}
