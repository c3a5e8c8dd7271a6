# SPDX-License-Identifier: BSD-3-Clause
"""Reference values that are computed here, without weft: the heavy elastica, roots, frequencies of plates."""
import math


def bisect(f, low, high):
    """The root of f between low and high, where f changes its sign."""
    sign = f(low) > 0.0
    for _ in range(200):
        middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        low, high = (middle, high) if (f(middle) > 0.0) == sign else (low, middle)
    return 0.5 * (low + high)


def elastica(load, steps=2000):
    """(W/L, H/L): reach and drop of the tip of a heavy elastica clamped level, load = density g L^3 / B.

    With phi the angle from the vertical and u the arc length from the tip, phi'' = load u sin phi, phi'(0) = 0 and
    phi(1) = 90 degrees: Runge-Kutta of order 4 from the tip, bisection of the logarithm of phi(0)."""
    h = 1.0 / steps

    def shoot(log_phi):
        phi, slope, reach, drop = math.exp(log_phi), 0.0, 0.0, 0.0
        for i in range(steps):
            u = i * h
            k1 = load * u * math.sin(phi)
            p2 = phi + 0.5 * h * slope
            k2 = load * (u + 0.5 * h) * math.sin(p2)
            p3 = p2 + 0.25 * h * h * k1
            k3 = load * (u + 0.5 * h) * math.sin(p3)
            p4 = phi + h * slope + 0.5 * h * h * k2
            k4 = load * (u + h) * math.sin(p4)
            after = phi + h * slope + h * h * (k1 + k2 + k3) / 6.0
            reach += h * (math.sin(phi) + 2.0 * math.sin(p2) + 2.0 * math.sin(p3) + math.sin(p4)) / 6.0
            drop += h * (math.cos(phi) + 2.0 * math.cos(p2) + 2.0 * math.cos(p3) + math.cos(p4)) / 6.0
            phi, slope = after, slope + h * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0
            if phi > math.pi:
                break
        return phi, reach, drop

    low, high = -60.0, math.log(0.5 * math.pi)
    for _ in range(52):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if shoot(middle)[0] < 0.5 * math.pi else (low, middle)
    return shoot(low)[1:]


def solve(a, b):
    """The solution of a x = b by elimination with pivots."""
    n = len(b)
    a = [list(row) + [value] for row, value in zip(a, b)]
    for i in range(n):
        best = max(range(i, n), key=lambda r: abs(a[r][i]))
        a[i], a[best] = a[best], a[i]
        for r in range(i + 1, n):
            factor = a[r][i] / a[i][i]
            if factor != 0.0:
                a[r][i:] = [x - factor * y for x, y in zip(a[r][i:], a[i][i:])]
    x = [0.0] * n
    for i in reversed(range(n)):
        x[i] = (a[i][n] - sum(a[i][j] * x[j] for j in range(i + 1, n))) / a[i][i]
    return x


def least_squares(rows, values):
    """x with the smallest |rows x - values|, by modified Gram-Schmidt."""
    columns = [list(column) for column in zip(*rows)]
    n, rest = len(columns), list(values)
    r = [[0.0] * n for _ in range(n)]
    y = []
    for i in range(n):
        r[i][i] = math.sqrt(sum(x * x for x in columns[i]))
        columns[i] = [x / r[i][i] for x in columns[i]]
        for j in range(i + 1, n):
            r[i][j] = sum(p * q for p, q in zip(columns[i], columns[j]))
            columns[j] = [q - r[i][j] * p for p, q in zip(columns[i], columns[j])]
        y.append(sum(p * q for p, q in zip(columns[i], rest)))
        rest = [q - y[i] * p for p, q in zip(columns[i], rest)]
    x = [0.0] * n
    for i in reversed(range(n)):
        x[i] = (y[i] - sum(r[i][j] * x[j] for j in range(i + 1, n))) / r[i][i]
    return x


def roots(coefficients):
    """Complex roots of a polynomial, highest power first, by Durand and Kerner."""
    n = len(coefficients) - 1
    monic = [c / coefficients[0] for c in coefficients]
    z = [(0.4 + 0.9j) ** k for k in range(n)]
    for _ in range(2000):
        most = 0.0
        for i in range(n):
            value = 0j
            for c in monic:
                value = value * z[i] + c
            for j in range(n):
                if j != i:
                    value /= z[i] - z[j]
            z[i] -= value
            most = max(most, abs(value))
        if most < 1e-14:
            break
    return z


def smoothed(signal, width):
    """The signal without its fast parts, every (width // 2)-th value: three means over `width` neighbours. A symmetric
    filter scales each cosine, and changes no frequency."""
    for _ in range(3):
        total = [0.0]
        for value in signal:
            total.append(total[-1] + value)
        signal = [(b - a) / width for a, b in zip(total, total[width:])]
    return signal[::width // 2]


def squares_of_frequencies(signal, interval, modes):
    """omega^2 [1/s^2] of a signal that is a sum of cos(omega t) and sin(omega t), ascending; growth has omega^2 < 0.

    A mode obeys s(t + dt) + s(t - dt) = mu s(t), mu = 2 cos(omega dt). The symmetric linear prediction of `modes` modes
    is fitted to the samples; its roots are the mu."""
    rows, values = [], []
    for i in range(modes, len(signal) - modes):
        rows.append([signal[i]] + [signal[i + j] + signal[i - j] for j in range(1, modes)])
        values.append(-(signal[i + modes] + signal[i - modes]))
    fit = least_squares(rows, values) + [1.0]
    powers = [[2.0], [0.0, 1.0]]  # z^j + z^-j as polynomials of mu, lowest power first
    while len(powers) <= modes:
        up, down = [0.0] + powers[-1], powers[-2] + [0.0] * 2
        powers.append([p - q for p, q in zip(up, down)])
    total = [0.0] * (modes + 1)
    for j, factor in enumerate(fit):
        for k, c in enumerate(powers[j]):
            total[k] += factor * c * (0.5 if j == 0 else 1.0)
    found = []
    for mu in roots(total[::-1]):
        if abs(mu.imag) < 1e-6 * max(1.0, abs(mu)) and mu.real > -2.0:
            half = 0.5 * mu.real
            found.append((math.acos(half) / interval) ** 2 if half <= 1.0 else -(math.acosh(half) / interval) ** 2)
    return sorted(found)


def smallest_eigenvalues(k, m, count):
    """The smallest eigenvalues of k x = lambda m x, k and m symmetric and m positive: Cholesky and Jacobi."""
    n = len(k)
    low = [[0.0] * n for _ in range(n)]
    for i in range(n):
        for j in range(i + 1):
            left = m[i][j] - sum(low[i][p] * low[j][p] for p in range(j))
            low[i][j] = math.sqrt(left) if i == j else left / low[j][j]

    def down(columns):
        out = []
        for column in columns:
            x = []
            for i in range(n):
                x.append((column[i] - sum(low[i][p] * x[p] for p in range(i))) / low[i][i])
            out.append(x)
        return out

    a = down(list(map(list, zip(*down(k)))))
    for _ in range(30):
        off = sum(a[i][j] ** 2 for i in range(n) for j in range(i))
        if off < 1e-22 * sum(a[i][i] ** 2 for i in range(n)):
            break
        for p in range(n):
            for q in range(p):
                if a[p][q] == 0.0:
                    continue
                t = 0.5 * (a[q][q] - a[p][p]) / a[p][q]
                t = (1.0 if t >= 0.0 else -1.0) / (abs(t) + math.sqrt(t * t + 1.0))
                c = 1.0 / math.sqrt(t * t + 1.0)
                s = t * c
                for row in a:
                    row[p], row[q] = c * row[p] - s * row[q], s * row[p] + c * row[q]
                rp, rq = a[p], a[q]
                a[p] = [c * x - s * y for x, y in zip(rp, rq)]
                a[q] = [s * x + c * y for x, y in zip(rp, rq)]
    return sorted(a[i][i] for i in range(n))[:count]


def lateral_buckling():
    """density g w L^3 / sqrt(EI GJ) at which a thin strip, clamped edge-on, buckles sideways by its weight.

    phi'' + (k^2 / 4) s^4 phi = 0, s from the tip, phi'(0) = 0 and phi(1) = 0: the first zero of its power series."""
    def tip(k):
        total = term = 1.0
        for i in range(1, 40):
            term *= -0.25 * k * k / (6 * i * (6 * i - 1))
            total += term
        return total

    return bisect(tip, 10.0, 15.0)


def square_plate(poisson, held, count=3, terms=7):
    """omega a^2 sqrt(density/B) of a square plate with one clamped edge ("cantilever") or four ("clamped"), by Ritz with
    Legendre polynomials times what is flat at the clamps: x^2, or x^2 (1 - x)^2 both ways."""
    points, weights = gauss(16)

    def legendre(j, x):
        """Value, first and second derivative of P_j(2 x - 1) by x."""
        y = 2.0 * x - 1.0
        p = [(1.0, 0.0, 0.0), (y, 1.0, 0.0)]
        for n in range(1, j):
            (a, da, dda), (b, db, ddb) = p[-1], p[-2]
            p.append((((2 * n + 1) * y * a - n * b) / (n + 1), db + (2 * n + 1) * a, ddb + (2 * n + 1) * da))
        return p[j][0], 2.0 * p[j][1], 4.0 * p[j][2]

    def along(j, x):
        p, dp, ddp = legendre(j, x)
        if held == "cantilever":
            f, df, ddf = x * x, 2.0 * x, 2.0
        else:
            b, db = x * (1.0 - x), 1.0 - 2.0 * x
            f, df, ddf = b * b, 2.0 * b * db, 2.0 * db * db - 4.0 * b
        return f * p, df * p + f * dp, ddf * p + 2.0 * df * dp + f * ddp

    def products(f, g, d, e):
        return [[sum(w * f(i, x)[d] * g(j, x)[e] for x, w in zip(points, weights)) for j in range(terms)] for i in range(terms)]

    fx, fy = along, legendre if held == "cantilever" else along
    x00, x11, x22, x02 = (products(fx, fx, *d) for d in ((0, 0), (1, 1), (2, 2), (0, 2)))
    y00, y11, y22, y02 = (products(fy, fy, *d) for d in ((0, 0), (1, 1), (2, 2), (0, 2)))
    size = range(terms * terms)
    k = [[0.0] * len(size) for _ in size]
    m = [[0.0] * len(size) for _ in size]
    for r in size:
        for s in size:
            (i, p), (j, q) = divmod(r, terms), divmod(s, terms)
            k[r][s] = (x22[i][j] * y00[p][q] + x00[i][j] * y22[p][q] + 2.0 * (1.0 - poisson) * x11[i][j] * y11[p][q]
                       + poisson * (x02[j][i] * y02[p][q] + x02[i][j] * y02[q][p]))
            m[r][s] = x00[i][j] * y00[p][q]
    return [math.sqrt(v) for v in smallest_eigenvalues(k, m, count)]


def gauss(n):
    """Points and weights of Gauss and Legendre on (0, 1)."""
    points, weights = [], []
    for i in range(n):
        x = math.cos(math.pi * (i + 0.75) / (n + 0.5))
        for _ in range(100):
            p, q = 1.0, 0.0
            for j in range(n):
                p, q = ((2 * j + 1) * x * p - j * q) / (j + 1), p
            slope = n * (x * p - q) / (x * x - 1.0)
            x, before = x - p / slope, x
            if x == before:
                break
        points.append(0.5 * (x + 1.0))
        weights.append(1.0 / ((1.0 - x * x) * slope * slope))
    return points, weights


def order(errors):
    """Observed orders of errors at spacings that are halved each time."""
    return [math.log2(abs(a / b)) if a * b != 0.0 else math.nan for a, b in zip(errors, errors[1:])]
