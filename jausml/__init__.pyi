from jausml.api.aio import AsyncComponent as AsyncComponent
from jausml.api.aio import AsyncSubscription as AsyncSubscription
from jausml.api.component import Component as Component
from jausml.api.component import Received as Received
from jausml.api.component import Subscription as Subscription
from jausml.api.messages import decode as decode
from jausml.api.messages import encode as encode
from jausml.api.models import ModelError as ModelError
from jausml.api.models import generate as generate
from jausml.api.models import read as read
from jausml.api.models import validate as validate
from jausml.live.messages import MessageError as MessageError
from jausml.live.peers.asking import NoAnswer as NoAnswer
from jausml.live.peers.operator import Refused as Refused

__version__: str
