"""DDS that stays on this machine: the loopback interface only, and a domain for each process."""

import os

LOOPBACK = (
    "<CycloneDDS><Domain><General>"
    "<Interfaces><NetworkInterface name='lo' multicast='false'/></Interfaces>"
    "<AllowMulticast>false</AllowMulticast>"
    "</General><Discovery><Peers><Peer address='127.0.0.1'/></Peers>"
    "<ParticipantIndex>auto</ParticipantIndex></Discovery></Domain></CycloneDDS>"
)
"""Value of ``CYCLONEDDS_URI``."""
DOMAIN = 100 + os.getpid() % 100
"""Tests that run at once must not meet."""
