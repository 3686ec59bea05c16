"""A lamp: a service switches it, and a topic tells whether it is on."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import SetBool


class Lamp(Node):
    """Provides /lamp/switch, and publishes on /lamp/light every `period` seconds."""

    def __init__(self) -> None:
        super().__init__("lamp")
        self.declare_parameter("period", 1.0)
        self.declare_parameter("name", "lamp")
        self.name = self.get_parameter("name").value
        self.is_on = False
        self.publisher = self.create_publisher(String, "/lamp/light", 10)
        self.service = self.create_service(SetBool, "/lamp/switch", self.switch)
        self.timer = self.create_timer(self.get_parameter("period").value, self.tell)

    def switch(self, request, response):
        """Switch the lamp, and say what it is now."""
        state = "on" if request.data else "off"
        response.success = self.is_on != request.data
        response.message = state if response.success else f"already {state}"
        self.is_on = request.data
        return response

    def tell(self) -> None:
        """Publish whether the lamp is on."""
        state = "on" if self.is_on else "off"
        self.publisher.publish(String(data=f"{self.name}: {state}"))


def main(args=None) -> None:
    """Run the node until Ctrl-C."""
    rclpy.init(args=args)
    node = Lamp()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
