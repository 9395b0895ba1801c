"""Reads a recording with public readers and compares it with what the writer expects.

Usage: read_back.py RECORDING EXPECTED.json

EXPECTED.json: {"messages": {topic: count}, "poses": {body: [x, y, z, w, tx, ty, tz]}}, the poses
being those of the last frame. Exit 0: as expected; 1: not, saying what; 3: a module is missing.
"""

import json
import struct
import sys
from collections import Counter

try:
    from mcap.reader import make_reader
    from mcap_protobuf.decoder import DecoderFactory
except ImportError as missing:
    print(f"module {missing.name} is missing", file=sys.stderr)
    sys.exit(3)


def main(recording, expected_path):
    with open(expected_path, encoding="utf-8") as file:
        expected = json.load(file)
    counts, schemas = Counter(), {}
    last_tf, last_contacts = None, None
    with open(recording, "rb") as file:
        reader = make_reader(file, validate_crcs=True)
        for schema, channel, message in reader.iter_messages():
            counts[channel.topic] += 1
            schemas[channel.topic] = schema.name
            if channel.topic == "/contacts":
                last_contacts = json.loads(message.data)
        summary_counts = {
            reader.get_summary().channels[id].topic: count
            for id, count in reader.get_summary().statistics.channel_message_counts.items()
        }
        metadata = {record.name: record.metadata for record in reader.iter_metadata()}
        attachments = [attachment.name for attachment in reader.iter_attachments()]
    with open(recording, "rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        decoded = Counter()
        for schema, channel, message, proto in reader.iter_decoded_messages(
            topics=[t for t in counts if schemas[t].startswith("foxglove.")]
        ):
            decoded[channel.topic] += 1
            if channel.topic == "/tf":
                last_tf = proto
                assert all(t.parent_frame_id == "world" for t in proto.transforms)

    assert dict(counts) == expected["messages"], f"counts {counts}"
    assert summary_counts == expected["messages"], f"the file's own counts {summary_counts}"
    assert all(decoded[t] == n for t, n in counts.items() if schemas[t].startswith("foxglove."))
    poses = {
        t.child_frame_id: [
            t.rotation.x, t.rotation.y, t.rotation.z, t.rotation.w,
            t.translation.x, t.translation.y, t.translation.z,
        ]
        for t in last_tf.transforms
    }
    assert poses == expected["poses"], f"poses {poses}"
    for pair in last_contacts["pairs"]:
        for name, pose in ((pair["a"], pair["pose_a"]), (pair["b"], pair["pose_b"])):
            bits = bytes.fromhex(pose["bits"])
            assert list(struct.unpack(">7d", bits)) == expected["poses"][name], name
    assert metadata["cranny"]["scene"] == "pendulum", f"metadata {metadata}"
    assert metadata["cranny.end"]["interrupted"] == "false", f"metadata {metadata}"
    assert attachments == ["pendulum.ron"], f"attachments {attachments}"
    print(f"read back {sum(counts.values())} messages on {len(counts)} topics, as expected")


if __name__ == "__main__":
    main(*sys.argv[1:])
