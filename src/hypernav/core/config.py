"""What all configuration has in common."""

from pydantic import BaseModel, ConfigDict


class RoomConfig(BaseModel):
    """Base of every room's configuration: frozen, and an unknown key is an error."""

    model_config = ConfigDict(frozen=True, extra="forbid")
