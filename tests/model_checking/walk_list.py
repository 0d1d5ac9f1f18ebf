"""Walks at random through a bridge that drives along lists, beside its abstract state."""

from jausml_runtime.bridge.ends.actions import Outcome
from jausml_runtime.messages import DeleteElement, SetElement
from lister.messages import ExecuteList, SetLocalWaypoint
from lister.ros_types import PoseStamped
from walk import Walk, main

ALL = 65535


class ListWalk(Walk):
    """Serves the action: a goal stands until it is canceled."""

    def listen(self):
        self.goal = None
        self.world.ros.serve_action("/follow", self)

    def accepts(self, _elements, _request):
        return True

    def begin(self, goal):
        assert self.goal is None
        self.goal = goal
        self.said = PoseStamped.from_cdr(goal.elements[0]).pose.position.x

    def cancel(self, goal):
        if goal is self.goal:
            self.goal = None
            self.said = 0.0
            goal.end(Outcome.CANCELED)

    def send(self, step):
        if step.what != "ExecuteList":
            super().send(step)
            return
        client = self.clients[step.actor]
        waypoint = SetLocalWaypoint(x=self._value(step.actor), y=0.0)
        data = SetElement.ElementData(0, waypoint.encode())
        deleted = DeleteElement.DeleteElementRec(element_uid=ALL)
        client.send(DeleteElement(delete_element_list=[deleted]), self.address)
        record = SetElement.ElementRec(1, 0, 0, data)
        client.send(SetElement(element_list=[record]), self.address)
        client.send(ExecuteList(speed=1.0, element_uid=1), self.address)

    def seen(self):
        return self._without_start(super().seen())

    def expected(self):
        return self._without_start(super().expected())

    @staticmethod
    def _without_start(facts):
        """Leaves out whether a stop is known to stand: none is sent at the start of lists."""
        return {name: fact for name, fact in facts.items() if name != "stopped"}


if __name__ == "__main__":
    main(ListWalk, "lister.ros2jaus")
