"""The wire: the messages between a robot and its server, version 1.

A search consists of these requests:

1. ``POST /v1/searches`` with `OpenSearch` gives `SearchOpened`.
2. ``POST /v1/searches/ID/observations`` with an observation (`hypernav.robot.wire.frames`) gives a
   `Reply`. Observations are numbered 0, 1, 2, … by `ObservationFacts.sequence`. The same over one
   WebSocket, ``/v1/searches/ID/stream``: observations as binary messages, `StreamMessage` back.
3. The robot executes ``reply.action`` once, observes, and goes on with the next number, until
   ``reply.done``.

What the numbers mean:

- The number that is expected next is accepted and answered once, unless what the robot senses can't
  be right (images that aren't newer than the last ones, or the same; odometry that jumps): then the
  search ends as ``robot failed``, and the reason says what is wrong.
- The number that was accepted last is a repetition: it gets the same answer and changes nothing,
  whatever is in its body.
- Every other number is refused: `ErrorBody` with ``error="sequence"`` and the ``expected`` number.
- If the answer takes longer than the deadline, the reply says ``hold``: stand still, and ask again,
  with the same number or by ``GET /v1/searches/ID/replies/SEQUENCE``. Over the WebSocket the answer
  follows without a request. Until then the next number is refused (``error="pending"``).

Stop overrides everything: after ``POST /v1/searches/ID/stop`` every observation of any number, a
pending one included, is answered by ``STOP``, ``done`` and the ending ``stopped``; over the
WebSocket this reply is also pushed at once. Whatever the body of a stop is, even none, it stops.
``POST /v1/searches/ID/close`` does the same for a search that is no longer needed, or with a
`CloseRequest` for a robot that ends by an error. After any other end every observation except a
repetition of the last is answered by ``STOP``, ``done`` and the ending. These answers change
nothing.

Everything is in metres, radians and seconds, frames as in REP 103 and 105: base x forward, y left,
z up; camera x right, y down, z forward; rotations counter-clockwise. Models are frozen; unknown
fields, NaN and infinity are errors. What a robot sends is in `requests` and `frames`, what it gets
in `replies`, and what both are made of in `values`.
"""
