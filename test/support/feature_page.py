"""A page without a browser: asks the dashboard's features, and keeps what they send."""

import asyncio
import inspect
import itertools
import json
import threading

import rosgraph
import rospy
import support

from robot_vision.dashboard.operations import OperationTable
from robot_vision.dashboard.sessions import Session

_numbers = itertools.count(1)


def subscribes(topic):
    """True if this process subscribes to a topic, as the master knows."""
    subscribers = dict(rosgraph.Master("/test").getSystemState()[1])
    return rospy.get_name() in subscribers.get(topic, [])


class Publishers:
    """Publishes latched messages on topics of any type; all topics end with the `with` block."""

    def __enter__(self):
        self._publishers = {}
        return self

    def __exit__(self, *_):
        for publisher in self._publishers.values():
            publisher.unregister()

    def __call__(self, topic, message):
        publisher = self._publisher(topic, message)
        publisher.publish(message)
        return publisher

    def to_reader(self, topic, message):
        """Publishes a message when somebody reads the topic.

        It is not kept for others: rospy might give one that is kept to that reader twice.
        """
        publisher = self._publisher(topic, message, latch=False)
        support.wait_for(publisher.get_num_connections, f"a reader of {topic}")
        publisher.publish(message)

    def _publisher(self, topic, message, latch=True):
        key = topic, type(message), latch
        if key not in self._publishers:
            self._publishers[key] = rospy.Publisher(*key[:2], queue_size=1000, latch=latch)
        return self._publishers[key]


class RefusedError(Exception):
    """The text that a page gets instead of a result."""


class FeaturePage:
    """A session with features, whose loop runs in a thread; it draws, and so acknowledges, all.

    Args:
        features: What has operations.
        draws: Whether it acknowledges what it gets on channels.

    Attributes:
        reads: Set while its connection takes what is sent; cleared, it takes one message more.
        ended: The code and the reason with which the session was closed, if it was.
    """

    def __init__(self, *features, role="control", draws=True):
        self.draws = draws
        self.reads = threading.Event()
        self.reads.set()
        self.ended = ()
        self.pushed = []  # kinds and data
        self.sent = []  # channels and whole messages
        self._answers = {}  # by id
        self._role = role
        self._table = OperationTable(one for feature in features for one in feature.operations)
        self._loop = asyncio.new_event_loop()
        threading.Thread(target=self._loop.run_forever, daemon=True).start()
        self.session = Session(next(_numbers), role, self._call, self._write, self._finish)

    def request(self, name, /, **fields):
        """The result of an operation; raises RefusedError with the text of an error."""
        return self.answer_to(self.start(name, **fields))

    def start(self, name, /, **fields):
        """Asks for an operation without waiting; the number for answer_to()."""
        operation, values = self._table.find(name, self._role, fields)
        number = next(_numbers)
        self._call(self.session.submit, number, operation, values)
        return number

    def answer_to(self, number):
        answer = support.wait_for(lambda: self._answers.get(number), f"the answer {number}")
        if "error" in answer:
            raise RefusedError(answer["error"])
        return answer["result"]

    def has_answer_to(self, number):
        return number in self._answers

    def pushes(self, kind):
        """The data of all pushes of a kind so far."""
        return [data for known, data in list(self.pushed) if known == kind]

    def wait_for_push(self, kind, matches=lambda _: True):
        """The newest push of a kind that matches, waited for."""

        def found():
            return [data for data in self.pushes(kind) if matches(data)]

        return support.wait_for(found, f"a push {kind}")[-1]

    def wait_for_newest(self, kind, matches):
        """The newest push of a kind once it matches, whatever came before."""

        def newest():
            return [data for data in self.pushes(kind)[-1:] if matches(data)]

        return support.wait_for(newest, f"a push {kind}")[0]

    def messages(self, channel):
        """What has come on a channel so far."""
        return [message for number, message in list(self.sent) if number == channel]

    def wait_for_message(self, channel, matches=lambda _: True):
        def found():
            return [one for one in self.messages(channel) if matches(one["data"])]

        return support.wait_for(found, f"a message on channel {channel}")[-1]

    def close(self):
        """Ends the session and waits until all that belongs to it has ended."""
        if self.session.closed:
            return
        self._call(self.session.end)
        support.wait_for(lambda: self.session.closed, "the end of the session")
        support.wait_for(lambda: not self.session.is_working(), "the end of the session's work")
        self._loop.call_soon_threadsafe(self._loop.stop)

    def _call(self, function, *arguments):
        def run():
            made = function(*arguments)
            if inspect.iscoroutine(made):
                self._loop.create_task(made)

        self._loop.call_soon_threadsafe(run)

    def _finish(self, *code_and_reason):
        self.ended = code_and_reason
        self.session.end()

    async def _write(self, data, binary):
        message = json.loads(data)
        if "id" in message:
            self._answers[message["id"]] = message
        elif message["push"] == "message":
            self.sent.append((message["channel"], message))
            if self.draws:
                self._call(self.session.acknowledge, message["channel"], message["seq"])
        else:
            self.pushed.append((message["push"], message["data"]))
        support.arrived.set()
        while not self.reads.is_set():
            await asyncio.sleep(0.01)
