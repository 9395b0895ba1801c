"""Answers queries about pairs of meshes with Coal, one line of JSON each.

The first line of standard input is an object: "meshes": list of {"vertices", "faces"}; "frames": for each frame a list of
pairs, each {"meshes": [of A, of B], "pose": that of B in the frame of A, 16 numbers, row by row}.

Each further line is a turn: {"what": "verdict" | "distance" | "contacts", "margin", "frames": indices}. Its answer is a
line {"seconds": one a frame, "answers": for each frame, for each pair, whether they meet or how far apart they are}.

Seconds are of the thread's CPU clock, less what the same calls take for two far triangles: Coal is called from Python
here, and the call is not Coal's.
"""

import functools
import json
import sys
import time

import coal
import numpy

CALLS = 2000


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


HERE = coal.Transform3s()


def query(what, margin):
    """A function of two bodies and the pose of the second."""
    if what == "distance":
        request, result = coal.DistanceRequest(), coal.DistanceResult()

        def distance(a, b, pose):
            result.clear()
            return coal.distance(a, HERE, b, pose, request, result)

        return distance
    request, result = coal.CollisionRequest(), coal.CollisionResult()
    request.enable_contact = what == "contacts"
    request.num_max_contacts = 1_000_000 if what == "contacts" else 1
    request.security_margin = margin

    def collide(a, b, pose):
        result.clear()
        return coal.collide(a, HERE, b, pose, request, result) > 0

    return collide


def seconds_of(work):
    start = time.thread_time()
    made = work()
    return time.thread_time() - start, made


@functools.cache
def call_seconds(what, margin):
    triangle = bvh([[0, 0, 0], [1e-3, 0, 0], [0, 1e-3, 0]], [[0, 1, 2]])
    away = coal.Transform3s()
    away.setTranslation(numpy.array([1e3, 0.0, 0.0]))
    call = query(what, margin)
    spent = [seconds_of(lambda: call(triangle, triangle, away))[0] for _ in range(CALLS)]
    return sorted(spent)[CALLS // 2]


def main():
    given = json.loads(sys.stdin.readline())
    meshes = [bvh(mesh["vertices"], mesh["faces"]) for mesh in given["meshes"]]
    frames = [[(*(meshes[m] for m in pair["meshes"]), placed(pair["pose"])) for pair in frame] for frame in given["frames"]]
    for line in sys.stdin:
        turn = json.loads(line)
        call = query(turn["what"], turn["margin"])
        overhead = call_seconds(turn["what"], turn["margin"])
        seconds, answers = [], []
        for frame in turn["frames"]:
            spent, made = seconds_of(lambda: [call(*pair) for pair in frames[frame]])
            seconds.append(max(spent - overhead * len(made), 1e-9))
            answers.append(made)
        print(json.dumps({"seconds": seconds, "answers": answers}), flush=True)


main()
