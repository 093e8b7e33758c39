"""What is in an MCAP file, by the reader of the format."""

from pathlib import Path

from mcap.reader import make_reader
from mcap.records import Statistics


def schemas_of(path: Path) -> dict[str, tuple[str, bytes]]:
    """Name and content of each topic's schema."""
    with path.open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    schemas = {number: (one.name, one.data) for number, one in summary.schemas.items()}
    return {channel.topic: schemas[channel.schema_id] for channel in summary.channels.values()}


def counts_of(path: Path) -> dict[str, int]:
    """Number of messages on each topic."""
    with path.open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    assert isinstance(summary.statistics, Statistics)
    messages = summary.statistics.channel_message_counts
    return {channel.topic: messages[number] for number, channel in summary.channels.items()}
