"""Messages of the JAUS core services (SAE AS5710A), and of the handoff of control (IOP).

Each class declares the fields of its message in their order on the wire, from which `wire.layout`
makes the codec. A `Query` message asks for the `Report` message of the same name. Names are those
of the standard. Record classes are attributes of their message, e.g.
`QueryServices.NodeRec`. Messages of IOP's digital resources are in `digital_resources`, and
those of this project's own MachineStates in `machine_states`.
"""

from .discovery import QueryConfiguration as QueryConfiguration
from .discovery import QueryIdentification as QueryIdentification
from .discovery import QueryServiceList as QueryServiceList
from .discovery import QueryServices as QueryServices
from .discovery import QuerySubsystemList as QuerySubsystemList
from .discovery import RegisterServices as RegisterServices
from .discovery import ReportConfiguration as ReportConfiguration
from .discovery import ReportIdentification as ReportIdentification
from .discovery import ReportServiceList as ReportServiceList
from .discovery import ReportServices as ReportServices
from .discovery import ReportSubsystemList as ReportSubsystemList
from .events import CancelEvent as CancelEvent
from .events import CommandEvent as CommandEvent
from .events import ConfirmEventRequest as ConfirmEventRequest
from .events import CreateCommandEvent as CreateCommandEvent
from .events import CreateEvent as CreateEvent
from .events import Event as Event
from .events import QueryEvents as QueryEvents
from .events import QueryEventTimeout as QueryEventTimeout
from .events import RejectEventRequest as RejectEventRequest
from .events import ReportEvents as ReportEvents
from .events import ReportEventTimeout as ReportEventTimeout
from .events import UpdateEvent as UpdateEvent
from .handoff import ConfirmHandoffRequest as ConfirmHandoffRequest
from .handoff import ConfirmReleaseControl as ConfirmReleaseControl
from .handoff import QueryEnhancedTimeout as QueryEnhancedTimeout
from .handoff import QueryHandoffTimeout as QueryHandoffTimeout
from .handoff import RemoveHandoffRequest as RemoveHandoffRequest
from .handoff import ReportEnhancedTimeout as ReportEnhancedTimeout
from .handoff import ReportHandoffTimeout as ReportHandoffTimeout
from .handoff import RequestHandoff as RequestHandoff
from .handoff import RequestReleaseControl as RequestReleaseControl
from .list_manager import ConfirmElementRequest as ConfirmElementRequest
from .list_manager import DeleteElement as DeleteElement
from .list_manager import QueryElement as QueryElement
from .list_manager import QueryElementCount as QueryElementCount
from .list_manager import QueryElementList as QueryElementList
from .list_manager import RejectElementRequest as RejectElementRequest
from .list_manager import ReportElement as ReportElement
from .list_manager import ReportElementCount as ReportElementCount
from .list_manager import ReportElementList as ReportElementList
from .list_manager import SetElement as SetElement
from .management import ClearEmergency as ClearEmergency
from .management import ConfirmControl as ConfirmControl
from .management import QueryAuthority as QueryAuthority
from .management import QueryControl as QueryControl
from .management import QueryHeartbeatPulse as QueryHeartbeatPulse
from .management import QueryStatus as QueryStatus
from .management import QueryTime as QueryTime
from .management import QueryTimeout as QueryTimeout
from .management import RejectControl as RejectControl
from .management import ReleaseControl as ReleaseControl
from .management import ReportAuthority as ReportAuthority
from .management import ReportControl as ReportControl
from .management import ReportHeartbeatPulse as ReportHeartbeatPulse
from .management import ReportStatus as ReportStatus
from .management import ReportTime as ReportTime
from .management import ReportTimeout as ReportTimeout
from .management import RequestControl as RequestControl
from .management import Reset as Reset
from .management import Resume as Resume
from .management import SetAuthority as SetAuthority
from .management import SetEmergency as SetEmergency
from .management import SetTime as SetTime
from .management import Shutdown as Shutdown
from .management import Standby as Standby
