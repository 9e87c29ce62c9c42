"""What the painters of script/ share: events of a journal, mixtures between piles, simple paths."""
import json
import math
import random
import sys

sys.dont_write_bytecode = True
rng = random.Random()
wrist = random.Random(3)  # how strokes are put down and lifted; of its own, so that it moves nothing else
count = 0
seconds = 0.0  # with the brush on the painting
spacing = 6    # [mm] of points, and the fewest pieces of a path
fewest = 4


def say(**event):
    print(json.dumps(event, separators=(", ", ": ")))


def jitter(amount):
    return rng.uniform(-amount, amount)


def mixed(first, second, t):
    """The pile between two piles."""
    names = sorted(set(first) | set(second))
    total_first, total_second = sum(first.values()), sum(second.values())
    parts = {n: (1 - t) * first.get(n, 0) / total_first + t * second.get(n, 0) / total_second for n in names}
    return {n: round(p, 3) for n, p in parts.items() if p >= 0.01}


def shade(piles, light):
    """From dark to light: piles at equal distances of light 0..1."""
    at = min(max(light, 0), 0.9999) * (len(piles) - 1)
    return mixed(piles[int(at)], piles[int(at) + 1], at - int(at))


def with_ends(path, size):
    """Points (x, y, part of the pressure): brushes are put down in a short way and lifted in a longer one, as the
    wrist has it. A third of the strokes is pressed off at once, and dabs are, too."""
    ways = [0.0]
    for (x0, y0), (x1, y1) in zip(path, path[1:]):
        ways.append(ways[-1] + math.dist((x0, y0), (x1, y1)))
    length = ways[-1]
    if length < 1.5 * size or wrist.random() < 0.35:
        return [(x, y, 1.0) for x, y in path]
    down = min(wrist.uniform(0.05, 0.25) * size, 0.15 * length)
    up = min(wrist.uniform(0.3, 1.3) * size, 0.4 * length)

    def part(way):
        return min(1.0, 0.25 + 0.75 * way / down, 0.04 + 0.96 * ((length - way) / up) ** 0.7)

    points = [(way, x, y) for way, (x, y) in zip(ways, path)]
    for way in (down, length - up, length - 0.6 * up, length - 0.25 * up):
        k = max(i for i in range(len(path) - 1) if ways[i] <= way)
        t = (way - ways[k]) / (ways[k + 1] - ways[k])
        points.append((way, path[k][0] + t * (path[k + 1][0] - path[k][0]), path[k][1] + t * (path[k + 1][1] - path[k][1])))
    points.sort()
    apart = [points[0]]
    for point in points[1:-1]:
        if min(point[0] - apart[-1][0], length - point[0]) > 0.02 * length:
            apart.append(point)
    return [(x, y, part(way)) for way, x, y in apart + [points[-1]]]


def stroke(path, brush, size, paint, pressure=0.6, load=1.0, start="clean", turn=0.0, speed=90, tilt=None, medium=0):
    """path: points in mm, speed in mm/s. The pressure is let go at the end, as a wrist does."""
    global count, seconds
    count += 1
    event = dict(event="stroke", brush={"preset": brush, "size_mm": round(size, 2)}, paint=paint, load=round(load, 2),
                 start=start, seed=count)
    if medium:
        event["medium"] = medium
    say(**event)
    time, way = 0.0, 0.0
    points = with_ends(path, size)
    length = sum(math.dist(a[:2], b[:2]) for a, b in zip(points, points[1:]))
    for i, (x, y, part) in enumerate(points):
        if i:
            step = math.dist(points[i - 1][:2], (x, y))
            time += step / speed
            way += step
        t = way / max(length, 1e-9)
        p = pressure * part * (0.55 + 0.5 * math.sin(math.pi * min(0.25 + t, 1))) + part * wrist.uniform(-0.03, 0.03)
        point = dict(event="point", t=round(time, 3), x=round(x, 2), y=round(y, 2), p=round(min(max(p, 0), 1), 3))
        if tilt:
            point["tx"], point["ty"] = tilt
        if turn:
            point["r"] = round(turn, 1)
        say(**point)
    say(event="end")
    seconds += time


def line(x0, y0, x1, y1, bow=0.0):
    n = max(fewest, int(math.dist((x0, y0), (x1, y1)) / spacing))
    length = math.dist((x0, y0), (x1, y1))
    nx, ny = -(y1 - y0) / length, (x1 - x0) / length
    points = []
    for i in range(n + 1):
        t = i / n
        b = bow * math.sin(math.pi * t) + jitter(0.25)
        points.append((x0 + (x1 - x0) * t + nx * b, y0 + (y1 - y0) * t + ny * b))
    return points


def arc(cx, cy, a, b, start, end):
    """Of an ellipse, angles in degrees."""
    n = max(4, int(abs(end - start) * (a + b) / 2 / 57 / (spacing / 1.5)))
    return [(cx + a * math.cos(math.radians(start + (end - start) * i / n)) + jitter(0.2),
             cy + b * math.sin(math.radians(start + (end - start) * i / n)) + jitter(0.2)) for i in range(n + 1)]
