"""The wire: the messages between a robot and its server, version 1.

A search reads as a short story:

1. ``POST /v1/searches`` with `OpenSearch` gives `SearchOpened`.
2. ``POST /v1/searches/ID/observations`` with an observation (`hypernav.robot.wire.frames`) gives a
   `Reply`. Observations are numbered 0, 1, 2, … by `ObservationFacts.sequence`. The same over one
   WebSocket, ``/v1/searches/ID/stream``: observations as binary messages, `StreamMessage` back.
3. The robot executes ``reply.action`` once, observes, and goes on with the next number, until
   ``reply.done``.

What the numbers mean:

- The number that is expected next is accepted and answered once.
- The number that was accepted last is a repetition: it gets the same answer and changes nothing,
  whatever is in its body.
- Every other number is refused: `ErrorBody` with ``error="sequence"`` and the ``expected`` one.
- If the answer takes longer than the deadline, the reply says ``hold``: stand still, and ask again,
  with the same number or by ``GET /v1/searches/ID/replies/SEQUENCE``. Over the WebSocket the answer
  follows on its own. The next number is refused for so long (``error="pending"``).

Stop always wins: from the moment of ``POST /v1/searches/ID/stop`` every observation of any number,
a pending one included, is answered by ``STOP``, ``done`` and the ending ``stopped``, for good; over
the WebSocket this reply is also pushed at once. ``POST /v1/searches/ID/close`` does the same for a
search that nobody needs any more. After any other end every observation but a repetition of the
last is answered by ``STOP``, ``done`` and the ending. None of these changes anything any more.

Everything is in metres, radians and seconds, frames as in REP 103 and 105: base x forward, y left,
z up; camera x right, y down, z forward; rotations counter-clockwise. Models are frozen; unknown
fields, NaN and infinity are errors.
"""
