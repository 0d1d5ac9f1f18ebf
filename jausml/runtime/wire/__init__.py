"""Messages as bytes: the parts of which generated message classes are made."""

from .codec import StampedMessage as StampedMessage
from .codec import TimeStamp as TimeStamp
from .codec import check_count as check_count
from .codec import check_presence as check_presence
from .codec import exactly as exactly
from .codec import integer as integer
from .codec import latin1 as latin1
from .codec import one_of as one_of
from .codec import padded as padded
from .codec import real as real
from .codec import scaled as scaled
from .codec import scaled_down as scaled_down
from .codec import scaled_up as scaled_up
from .codec import sized as sized
from .codec import take as take
from .codec import take_text as take_text
from .codec import unpadded as unpadded
from .codec import whole as whole
from .codec import whole_of as whole_of
from .message import DecodeError as DecodeError
from .message import EncodeError as EncodeError
from .message import Message as Message
from .records import Octet as Octet
from .records import octet_records as octet_records
from .records import write_records as write_records
