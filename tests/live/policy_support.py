"""What an SROS 2 policy allows, and what a node of ROS has, in the same words."""

from collections import defaultdict

from lxml import etree

_USES = {
    "topics": ("publish", "subscribe"),
    "services": ("reply", "request"),
    "actions": ("execute", "call"),
}


def allowed(policy: str) -> dict[str, set[str]]:
    """The names that a policy of one node allows, by their use; actions as what they consist of."""
    (profile,) = etree.fromstring(policy.encode()).iter("profile")
    found: defaultdict[str, set[str]] = defaultdict(set)
    for group in profile.iterchildren(etree.Element):
        (use,) = group.attrib
        assert use in _USES[group.tag]
        assert group.get(use) == "ALLOW"
        for element in group:
            assert element.tag == group.tag.removesuffix("s")
            if group.tag == "actions":
                _allow_action(found, element.text, serves=use == "execute")
            else:
                found[use].add(element.text)
    return dict(found)


def _allow_action(found: dict[str, set[str]], action: str, *, serves: bool) -> None:
    requests = {f"{action}/_action/{name}" for name in ("send_goal", "cancel_goal", "get_result")}
    found["reply" if serves else "request"] |= requests
    told = {f"{action}/_action/{name}" for name in ("feedback", "status")}
    found["publish" if serves else "subscribe"] |= told


def graph(observer, name: str, namespace: str) -> dict[str, set[str]]:
    """The names that a node has, by their use, as another node sees them."""
    ask = {
        "publish": observer.get_publisher_names_and_types_by_node,
        "subscribe": observer.get_subscriber_names_and_types_by_node,
        "reply": observer.get_service_names_and_types_by_node,
        "request": observer.get_client_names_and_types_by_node,
    }
    found = {use: {topic for topic, _ in names(name, namespace)} for use, names in ask.items()}
    return {use: names for use, names in found.items() if names}
