from jausml.live.api.aio import AsyncComponent as AsyncComponent
from jausml.live.api.aio import AsyncSubscription as AsyncSubscription
from jausml.live.api.component import Component as Component
from jausml.live.api.component import ComponentStatus as ComponentStatus
from jausml.live.api.messages import Received as Received
from jausml.live.api.messages import Subscription as Subscription
from jausml.live.api.messages import decode as decode
from jausml.live.api.messages import encode as encode
from jausml.live.api.models import ModelError as ModelError
from jausml.live.api.models import generate as generate
from jausml.live.api.models import read as read
from jausml.live.api.models import validate as validate
from jausml.live.messages import MessageError as MessageError
from jausml.live.peers.query_client import NoAnswer as NoAnswer
from jausml.live.peers.query_client import Refused as Refused

__version__: str
