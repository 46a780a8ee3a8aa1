# SPDX-License-Identifier: Apache-2.0
"""The node: lifecycle states, parameters and services around slipwise's live node.

unconfigured -> configure: the parameters are read -> inactive -> activate: it learns and publishes -> active.
Deactivated, it keeps what it learned; cleanup forgets all but the cache.
"""

from __future__ import annotations

import math
import os
import sys
import threading
from typing import NoReturn

import rclpy
from geometry_msgs.msg import PoseStamped
from rcl_interfaces.msg import SetParametersResult
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn
from rclpy.parameter import Parameter
from slipwise_msgs.srv import PredictPath
from std_srvs.srv import SetBool, Trigger

from slipwise.errors import SlipwiseError
from slipwise.live.outputs import Path
from slipwise.live.ros_messages import stamp_ns
from slipwise.live.samples import Answer
from slipwise.live.typed_messages import asked_of
from slipwise_ros.parameters import AUTOSTART, chosen, declare, declared
from slipwise_ros.runner import Kind, Runner

INACTIVE = "the node is not active"
LEAVE_WITHIN = 5.0  # s for which the middleware may end its threads


class SlipwiseNode(LifecycleNode):
    """Learns the motion model of a robot while it drives."""

    def __init__(self) -> None:
        super().__init__("slipwise")
        declare(self)
        self._read_once = {each.name for each in declared()}
        self._runner: Runner | None = None
        self._active = False
        self.add_on_set_parameters_callback(self._may_set)
        self.create_service(Trigger, "~/apply", self._apply)
        self.create_service(Trigger, "~/save", self._save)
        self.create_service(Trigger, "~/reset", self._reset)
        self.create_service(SetBool, "~/freeze", self._freeze)
        self.create_service(PredictPath, "~/predict_path", self._predict)
        if self.get_parameter(AUTOSTART).value:
            self.trigger_configure()
            self.trigger_activate()

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Read the parameters; a wrong one is said, and the node stays unconfigured."""
        try:
            settings, options = chosen(self)
        except SlipwiseError as problem:
            self.get_logger().error(str(problem))
            return TransitionCallbackReturn.FAILURE
        self._runner = Runner(self, settings, options, self.get_logger().error)
        return super().on_configure(state)

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Wait for the robot's topics in a thread, then learn."""
        assert self._runner is not None
        self._runner.start()
        self._active = True
        return super().on_activate(state)

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Stop learning and publishing; what was learned is kept."""
        self.stop()
        return super().on_deactivate(state)

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Forget all but what the cache has."""
        self.stop()
        self._runner = None
        return super().on_cleanup(state)

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """End in order."""
        self.stop()
        return super().on_shutdown(state)

    def destroy_node(self) -> None:
        """End in order, and leave the graph."""
        self.stop()
        super().destroy_node()

    def stop(self) -> None:
        """Stop learning; the cache is written."""
        self._active = False
        if self._runner is not None:
            self._runner.stop()

    def _may_set(self, parameters: list[Parameter]) -> SetParametersResult:
        late = [each.name for each in parameters if each.name in self._read_once]
        if self._runner is None or not late:
            return SetParametersResult(successful=True)
        reason = f"{', '.join(late)}: read when the node is configured; deactivate and clean it up first"
        return SetParametersResult(successful=False, reason=reason)

    def _ask(self, kind: Kind, content: str = "") -> Answer:
        if self._runner is None or not self._active:
            return Answer(False, INACTIVE)
        return self._runner.ask(kind, content)

    def _apply(self, _request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        return _say(self._ask("apply"), response)

    def _save(self, _request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        return _say(self._ask("save"), response)

    def _freeze(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        return _say(self._ask("freeze" if request.data else "resume"), response)

    def _reset(self, _request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        if self._runner is None or not self._active:
            return _say(Answer(False, INACTIVE), response)
        self._runner.stop()
        self._runner.start(forget=True)
        return _say(Answer(True, "learning begins from nothing"), response)

    def _predict(self, request: PredictPath.Request, response: PredictPath.Response) -> PredictPath.Response:
        answer = self._ask("predict", asked_of(request))
        _say(answer, response)
        if answer.path is not None:
            _fill(response, answer.path)
        return response


def _say(answer: Answer, response: object) -> object:
    response.success, response.message = answer.success, answer.message  # type: ignore[attr-defined]
    return response


def _fill(response: PredictPath.Response, path: Path) -> None:
    response.path.header.frame_id = path.frame
    for t, (x, y, yaw) in zip(path.t.tolist(), path.poses.tolist(), strict=True):
        pose = PoseStamped()
        pose.header.frame_id = path.frame
        pose.header.stamp.sec, pose.header.stamp.nanosec = divmod(stamp_ns(t), 1_000_000_000)
        pose.pose.position.x, pose.pose.position.y = x, y
        pose.pose.orientation.z, pose.pose.orientation.w = math.sin(yaw / 2), math.cos(yaw / 2)
        response.path.poses.append(pose)
    if response.path.poses:
        response.path.header.stamp = response.path.poses[0].header.stamp
    response.covariance = path.covariance.ravel().tolist()


def main() -> None:
    """Run the node until it is interrupted."""
    rclpy.init()
    node = SlipwiseNode()
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    try:
        while rclpy.ok():  # each second: an interrupt just before a wait does not end it
            executor.spin_once(timeout_sec=1.0)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    except Exception:
        if rclpy.ok():
            raise
        # an interrupt shut the middleware down amid a call, which then fails
    _leave(node)


def _leave(node: SlipwiseNode) -> NoReturn:
    """End in order, the cache written; threads of the middleware that do not end in time are left behind."""
    node.stop()
    late = threading.Timer(LEAVE_WITHIN, os._exit, (0,))
    late.daemon = True
    late.start()
    node.destroy_node()
    rclpy.try_shutdown()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(0)
