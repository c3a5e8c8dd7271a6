# SPDX-License-Identifier: BSD-3-Clause
"""Small SVG pictures: curves with axes, and outlines of cloth."""
import math

COLOURS = ("#1f6feb", "#d1242f", "#1a7f37", "#9a6700", "#8250df", "#57606a")
HEAD = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 %d %d" font-family="sans-serif" font-size="11">\n' \
       '<rect width="100%%" height="100%%" fill="white"/>\n'


def ticks(low, high, log):
    if log:
        return [10.0 ** k for k in range(math.ceil(low - 1e-9), math.floor(high + 1e-9) + 1)]
    step = 10.0 ** math.floor(math.log10(high - low))
    step = next(s for s in (step / 5, step / 2, step, step * 2) if (high - low) / s <= 6)
    return [k * step for k in range(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)]


def plot(curves, across, up, logx=False, logy=False, lines=(), size=(460, 270)):
    """curves: (name, [(x, y)], "line" | "dots"); lines: (name, y), level lines. Names of axes are texts."""
    fx, fy = (math.log10 if log else float for log in (logx, logy))
    points = [(fx(x), fy(y)) for _, curve, _ in curves for x, y in curve]
    xs, ys = [p[0] for p in points], [p[1] for p in points] + [fy(y) for _, y in lines]
    (x0, x1), (y0, y1) = ((min(v), max(v)) for v in (xs, ys))
    x1, y1 = x1 + (x1 == x0), y1 + (y1 == y0)
    x0, x1 = x0 - 0.04 * (x1 - x0), x1 + 0.04 * (x1 - x0)
    y0, y1 = y0 - 0.06 * (y1 - y0), y1 + 0.06 * (y1 - y0)
    left, right, top, bottom = 58, size[0] - 12, 10 + 14 * math.ceil((len(curves) + len(lines)) / 2), size[1] - 38

    def at(x, y):
        return (left + (right - left) * (x - x0) / (x1 - x0), bottom - (bottom - top) * (y - y0) / (y1 - y0))

    out = [HEAD % size]
    for value in ticks(x0, x1, logx):
        x, _ = at(fx(value), y0)
        out.append(f'<path d="M{x:.1f} {bottom}V{top}" stroke="#ddd"/>'
                   f'<text x="{x:.1f}" y="{bottom + 14}" text-anchor="middle">{value:g}</text>\n')
    for value in ticks(y0, y1, logy):
        _, y = at(x0, fy(value))
        out.append(f'<path d="M{left} {y:.1f}H{right}" stroke="#ddd"/>'
                   f'<text x="{left - 5}" y="{y + 4:.1f}" text-anchor="end">{value:g}</text>\n')
    out.append(f'<rect x="{left}" y="{top}" width="{right - left}" height="{bottom - top}" fill="none" stroke="#666"/>\n')
    out.append(f'<text x="{(left + right) / 2}" y="{size[1] - 8}" text-anchor="middle">{across}</text>\n')
    out.append(f'<text transform="translate(13 {(top + bottom) / 2}) rotate(-90)" text-anchor="middle">{up}</text>\n')
    named = [(name, COLOURS[i % len(COLOURS)]) for i, (name, _, _) in enumerate(curves)] + [(n, "#888") for n, _ in lines]
    for i, (name, colour) in enumerate(named):
        x, y = left + (i % 2) * (right - left) / 2, 14 + 14 * (i // 2)
        out.append(f'<rect x="{x}" y="{y - 8}" width="9" height="9" fill="{colour}"/><text x="{x + 13}" y="{y}">{name}</text>\n')
    for _, level in lines:
        _, y = at(x0, fy(level))
        out.append(f'<path d="M{left} {y:.1f}H{right}" stroke="#888" stroke-dasharray="5 3"/>\n')
    for i, (_, curve, kind) in enumerate(curves):
        colour = COLOURS[i % len(COLOURS)]
        places = [at(fx(x), fy(y)) for x, y in curve]
        if kind == "line":
            path = "M" + "L".join("%.1f %.1f" % p for p in places)
            out.append(f'<path d="{path}" fill="none" stroke="{colour}" stroke-width="1.5"/>\n')
        else:
            out.extend(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{colour}"/>' for x, y in places)
            out.append("\n")
    return "".join(out) + "</svg>\n"


def sheets(pictures, size=(230, 230)):
    """Wire frames or outlines side by side: (title, [polyline of points (x, y), y up])."""
    out = [HEAD % (size[0] * len(pictures), size[1] + 18)]
    for k, (title, polylines) in enumerate(pictures):
        xs = [x for line in polylines for x, _ in line]
        ys = [y for line in polylines for _, y in line]
        scale = 0.92 * min(size[0] / (max(xs) - min(xs)), size[1] / (max(ys) - min(ys)))
        mx, my = 0.5 * (max(xs) + min(xs)), 0.5 * (max(ys) + min(ys))
        ox, oy = size[0] * (k + 0.5), 18 + 0.5 * size[1]
        path = "".join("M" + "L".join(f"{ox + scale * (x - mx):.1f} {oy - scale * (y - my):.1f}" for x, y in line)
                       for line in polylines)
        out.append(f'<text x="{ox}" y="14" text-anchor="middle">{title}</text>\n'
                   f'<path d="{path}" fill="none" stroke="#1f6feb" stroke-width="0.6"/>\n')
    return "".join(out) + "</svg>\n"
