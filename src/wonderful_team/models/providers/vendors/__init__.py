"""The makers' own services by name, one file each, and what servers named by their address have in common."""

from wonderful_team.models.providers.vendors.anthropic import ANTHROPIC
from wonderful_team.models.providers.vendors.google import GOOGLE
from wonderful_team.models.providers.vendors.openai import CHAT, OPENAI, RESPONSES
from wonderful_team.models.providers.vendors.openrouter import OPENROUTER
from wonderful_team.models.providers.vendors.server import SERVER, SERVER_KEY
from wonderful_team.models.providers.vendors.vendor import Vendor

VENDORS: dict[str, Vendor] = {
    "openai": OPENAI,
    "openai-responses": RESPONSES,
    "openai-chat": CHAT,
    "anthropic": ANTHROPIC,
    "google": GOOGLE,
    "openrouter": OPENROUTER,
}

__all__ = ["SERVER", "SERVER_KEY", "VENDORS", "Vendor"]
