"""Models of vendors and servers, through one client library that is imported only when a request is sent."""

from wonderful_team.models.providers.listing import server_models
from wonderful_team.models.providers.make import load_library, make_provider
from wonderful_team.models.providers.options import ModelOptions, PriceChoice, check_prices, model_options
from wonderful_team.models.providers.provider import Provider
from wonderful_team.models.providers.settings import Thinking
from wonderful_team.models.providers.specs import is_provider_spec, parse_spec
from wonderful_team.models.providers.vendors import SERVER_KEY, VENDORS

__all__ = [
    "SERVER_KEY",
    "VENDORS",
    "ModelOptions",
    "PriceChoice",
    "Provider",
    "Thinking",
    "check_prices",
    "is_provider_spec",
    "load_library",
    "make_provider",
    "model_options",
    "parse_spec",
    "server_models",
]
