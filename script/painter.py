"""What the painters of script/ share: events of a journal, mixtures between piles, simple paths."""
import json
import math
import random
import sys

sys.dont_write_bytecode = True
rng = random.Random()
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


def stroke(path, brush, size, paint, pressure=0.6, load=1.0, start="clean", turn=0.0, speed=90, tilt=None, medium=0):
    """path: points in mm, speed in mm/s. The pressure is let go at the end, as a wrist does."""
    global count, seconds
    count += 1
    event = dict(event="stroke", brush={"preset": brush, "size_mm": round(size, 2)}, paint=paint, load=round(load, 2),
                 start=start, seed=count)
    if medium:
        event["medium"] = medium
    say(**event)
    time = 0.0
    for i, (x, y) in enumerate(path):
        t = i / max(len(path) - 1, 1)
        if i:
            time += math.dist(path[i - 1], path[i]) / speed
        p = pressure * (0.55 + 0.5 * math.sin(math.pi * min(0.25 + t, 1))) + jitter(0.03)
        point = dict(event="point", t=round(time, 3), x=round(x, 2), y=round(y, 2), p=round(min(max(p, 0), 1), 2))
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
