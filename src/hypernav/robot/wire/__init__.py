"""The contract between a robot and its server: messages, and observations as bytes."""
