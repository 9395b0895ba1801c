"""Asks Coal about a pair of meshes at each of many poses, and prints the seconds a query, one line a question.

Standard input: one JSON object: "meshes": two of {"vertices", "faces"}; "poses": those of the second, 16 numbers
each, row by row; "asked": list of {"what": "intersects" | "distance" | "contacts", "margin"}; "seconds": what one
run over all poses may take at most; of dearer questions fewer poses are asked, evenly spread.

Seconds are of the thread's CPU clock, best of three runs, less what the same call takes for two far triangles: Coal is
called from Python here, and the call is not Coal's.
"""

import json
import sys
import time

import coal
import numpy

RUNS = 3


def bvh(vertices, faces):
    model = coal.BVHModelOBBRSS()
    model.beginModel(len(faces), len(vertices))
    model.addVertices(numpy.array(vertices, dtype=float))
    model.addTriangles(numpy.array(faces, dtype=numpy.int64))
    model.endModel()
    return model


def placed(pose):
    rows = numpy.array(pose).reshape(4, 4)
    return coal.Transform3s(rows[:3, :3], rows[:3, 3])


def question(asked):
    """A function of two bodies with poses."""
    if asked["what"] == "distance":
        request = coal.DistanceRequest()
        request.enable_nearest_points = True

        def ask(a, here, b, there):
            coal.distance(a, here, b, there, request, coal.DistanceResult())

        return ask
    request = coal.CollisionRequest()
    request.enable_contact = asked["what"] == "contacts"
    request.num_max_contacts = 1_000_000 if asked["what"] == "contacts" else 1
    request.security_margin = asked["margin"]

    def ask(a, here, b, there):
        coal.collide(a, here, b, there, request, coal.CollisionResult())

    return ask


def seconds(ask, bodies, poses):
    a, b = bodies
    here = coal.Transform3s()
    best = float("inf")
    for _ in range(RUNS):
        start = time.thread_time()
        for there in poses:
            ask(a, here, b, there)
        best = min(best, time.thread_time() - start)
    return best / len(poses)


def main():
    given = json.load(sys.stdin)
    bodies = [bvh(mesh["vertices"], mesh["faces"]) for mesh in given["meshes"]]
    poses = [placed(pose) for pose in given["poses"]]
    triangle = bvh([[0, 0, 0], [1e-3, 0, 0], [0, 1e-3, 0]], [[0, 1, 2]])
    away = coal.Transform3s()
    away.setTranslation(numpy.array([1e3, 0.0, 0.0]))
    for asked in given["asked"]:
        ask = question(asked)
        call = seconds(ask, [triangle] * 2, [away] * 1000)
        one = seconds(ask, bodies, poses[:2])
        stride = max(1, min(len(poses), int(one * len(poses) / given["seconds"])))
        print(seconds(ask, bodies, poses[::stride]) - call, flush=True)


main()
