"""Checks the links of a robot with FCL or Coal, one line of JSON each.

The first line of standard input is an object: "links": for each link null, {"vertices", "faces"}, or {"kind": "ball" |
"capsule" | "cylinder", "radius", "length", "pose"}; "frames": for each configuration {"poses": of all links, 16 numbers
each, row by row; "near": pairs of links whose boxes overlap; "order": [a, b, distance of their boxes], ascending}.

Each further line is a turn: {"library": "fcl" | "coal", "what": "meeting" | "nearest", "frames": indices}. Its answer is
a line {"seconds": one a frame, "hits": pairs, one list a frame, "nearest": [a, b, distance] or null, one a frame}.

The broad phase is given: neither its time nor that of placing the links counts. Seconds are of the thread's CPU clock,
less what as many calls take for two far balls: the libraries are called from Python here, and the call is not theirs.
A mesh of twelve faces that is a box is a box of the library.
"""

import functools
import itertools
import json
import sys
import time

import numpy

CALLS = 2000


def rigid(rows):
    return numpy.array(rows, dtype=float).reshape(4, 4)


def box_of(vertices, faces):
    """(sides, pose) of a mesh that is a box; else None."""
    if len(vertices) != 8 or len(faces) != 12:
        return None
    points = numpy.array(vertices, dtype=float)
    edges = points[1:] - points[0]
    size = numpy.abs(edges).max()
    for three in itertools.combinations(range(7), 3):
        sides = edges[list(three)]
        lengths = numpy.linalg.norm(sides, axis=1)
        gram = sides @ sides.T - numpy.diag(lengths**2)
        if numpy.abs(gram).max() > 1e-9 * size**2:
            continue
        corners = {tuple(numpy.round((points[0] + bits @ sides) / size, 6) + 0.0) for bits in map(numpy.array, itertools.product((0, 1), repeat=3))}
        if corners != {tuple(numpy.round(point / size, 6) + 0.0) for point in points}:
            continue
        axes = (sides / lengths[:, None]).T
        if numpy.linalg.det(axes) < 0:
            axes[:, 2] *= -1
        pose = numpy.eye(4)
        pose[:3, :3], pose[:3, 3] = axes, points.mean(axis=0)
        return lengths, pose
    return None


class Fcl:
    def __init__(self):
        import fcl

        self.fcl = fcl
        self.collision, self.gap = fcl.CollisionRequest(), fcl.DistanceRequest()

    def bvh(self, vertices, faces):
        model = self.fcl.BVHModel()
        model.beginModel(len(vertices), len(faces))
        model.addSubModel(numpy.array(vertices, dtype=float), numpy.array(faces, dtype=numpy.int64))
        model.endModel()
        return model

    def primitive(self, kind, radius, length):
        fcl = self.fcl
        return {"ball": lambda: fcl.Sphere(radius), "capsule": lambda: fcl.Capsule(radius, length), "cylinder": lambda: fcl.Cylinder(radius, length)}[kind]()

    def box(self, sides):
        return self.fcl.Box(*sides)

    def place(self, geometry, pose):
        return self.fcl.CollisionObject(geometry, self.fcl.Transform(pose[:3, :3], pose[:3, 3]))

    def meets(self, a, b):
        return self.fcl.collide(a, b, self.collision, self.fcl.CollisionResult()) > 0

    def distance(self, a, b):
        return self.fcl.distance(a, b, self.gap, self.fcl.DistanceResult())


class Coal:
    def __init__(self):
        import coal

        self.coal = coal
        self.collision, self.gap = coal.CollisionRequest(), coal.DistanceRequest()
        self.collided, self.measured = coal.CollisionResult(), coal.DistanceResult()
        self.collision.num_max_contacts, self.collision.enable_contact = 1, False

    def bvh(self, vertices, faces):
        model = self.coal.BVHModelOBBRSS()
        model.beginModel(len(faces), len(vertices))
        model.addVertices(numpy.array(vertices, dtype=float))
        model.addTriangles(numpy.array(faces, dtype=numpy.int64))
        model.endModel()
        return model

    def primitive(self, kind, radius, length):
        coal = self.coal
        return {"ball": lambda: coal.Sphere(radius), "capsule": lambda: coal.Capsule(radius, length), "cylinder": lambda: coal.Cylinder(radius, length)}[kind]()

    def box(self, sides):
        return self.coal.Box(*sides)

    def place(self, geometry, pose):
        return geometry, self.coal.Transform3s(pose[:3, :3], pose[:3, 3])

    def meets(self, a, b):
        self.collided.clear()
        return self.coal.collide(*a, *b, self.collision, self.collided) > 0

    def distance(self, a, b):
        self.measured.clear()
        return self.coal.distance(*a, *b, self.gap, self.measured)


class Links:
    """The links of a robot in a library, at every configuration."""

    def __init__(self, library, links, frames):
        self.library, self.frames = library, frames
        geometries = [self.geometry(link) for link in links]
        self.placed = [
            [made and library.place(made[0], rigid(pose) @ made[1]) for made, pose in zip(geometries, frame["poses"])] for frame in frames
        ]

    def geometry(self, link):
        if link is None:
            return None
        if "kind" in link:
            return self.library.primitive(link["kind"], link["radius"], link["length"]), rigid(link["pose"])
        box = box_of(link["vertices"], link["faces"])
        if box:
            return self.library.box(box[0]), box[1]
        return self.library.bvh(link["vertices"], link["faces"]), numpy.eye(4)

    def check(self, frame, nearest):
        """(calls of two kinds, hits, the nearest pair)."""
        placed, library = self.placed[frame], self.library
        near = self.frames[frame]["near"]
        hits = [pair for pair in near if library.meets(placed[pair[0]], placed[pair[1]])]
        if not nearest:
            return (len(near), 0), hits, None
        if hits:
            return (len(near), 0), hits, [*hits[0], 0.0]
        best, calls = None, 0
        for a, b, bound in self.frames[frame]["order"]:
            if best and bound > best[2]:
                break
            distance, calls = library.distance(placed[a], placed[b]), calls + 1
            if best is None or distance < best[2]:
                best = [a, b, distance]
        return (len(near), calls), hits, best


@functools.cache
def call_seconds(library):
    """Of a verdict and of a distance, for two far balls."""
    away = numpy.eye(4)
    away[0, 3] = 1e3
    here, there = (library.place(library.primitive("ball", 1.0, 0.0), pose) for pose in (numpy.eye(4), away))
    return [sorted(seconds_of(lambda: call(here, there))[0] for _ in range(CALLS))[CALLS // 2] for call in (library.meets, library.distance)]


def seconds_of(work):
    start = time.thread_time()
    made = work()
    return time.thread_time() - start, made


def main():
    given = json.loads(sys.stdin.readline())

    @functools.cache
    def links_of(name):
        return Links({"fcl": Fcl, "coal": Coal}[name](), given["links"], given["frames"])

    for line in sys.stdin:
        turn = json.loads(line)
        links = links_of(turn["library"])
        of_calls = call_seconds(links.library)
        answer = {"seconds": [], "hits": [], "nearest": []}
        for frame in turn["frames"]:
            spent, (calls, hits, nearest) = seconds_of(lambda: links.check(frame, turn["what"] == "nearest"))
            overhead = sum(count * seconds for count, seconds in zip(calls, of_calls))
            answer["seconds"].append(max(spent - overhead, 1e-9))
            answer["hits"].append(hits)
            answer["nearest"].append(nearest)
        print(json.dumps(answer), flush=True)


main()
