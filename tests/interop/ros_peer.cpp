// A robot on Fast DDS, the middleware of most of ROS 2, on the loopback interface; mapmeld speaks Cyclone DDS.
//
//   ros_peer publish DOMAIN     a map on rt/map and a transform on rt/tf, until its input ends
//   ros_peer listen DOMAIN      tells the first map on rt/mapmeld/map and the first transforms on rt/tf_static
//   ros_peer record FOLDER      the same two messages as the bytes that are sent: map.cdr, tf.cdr
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>

#include <chrono>
#include <fstream>
#include <iostream>
#include <string>
#include <thread>

#include "ros_messagesPubSubTypes.h"

using namespace eprosima::fastdds::dds;
using eprosima::fastrtps::rtps::IPLocator;
using eprosima::fastrtps::rtps::Locator_t;
using eprosima::fastrtps::rtps::SerializedPayload_t;
using MapType = nav_msgs::msg::dds_::OccupancyGrid_PubSubType;
using TransformsType = tf2_msgs::msg::dds_::TFMessage_PubSubType;

nav_msgs::msg::dds_::OccupancyGrid_ drawn_map() {
  nav_msgs::msg::dds_::OccupancyGrid_ map;
  map.header().stamp().sec(1700000000);
  map.header().stamp().nanosec(250000000);
  map.header().frame_id("robot/map");
  map.info().resolution(0.05f);
  map.info().width(40);
  map.info().height(30);
  map.info().origin().position().x(-1.25);
  map.info().origin().position().y(2.5);
  map.info().origin().orientation().w(1.0);
  for (unsigned cell = 0; cell < 40 * 30; ++cell) {
    const unsigned x = cell % 40, y = cell / 40;
    const bool wall = x == 0 || x == 39 || y == 0 || y == 29;
    map.data().push_back(cell == 0 ? static_cast<uint8_t>(-1) : wall ? 100 : 0);
  }
  return map;
}

tf2_msgs::msg::dds_::TFMessage_ drawn_transforms() {
  geometry_msgs::msg::dds_::TransformStamped_ one;
  one.header().stamp().sec(1700000000);
  one.header().frame_id("robot/map");
  one.child_frame_id("robot/base_link");
  one.transform().translation().x(3.0);
  one.transform().translation().y(-4.0);
  one.transform().rotation().z(0.6);
  one.transform().rotation().w(0.8);
  tf2_msgs::msg::dds_::TFMessage_ message;
  message.transforms().push_back(one);
  return message;
}

DomainParticipant* participant_of(int domain) {
  DomainParticipantQos qos;
  auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList.push_back("127.0.0.1");
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(udp);
  Locator_t here;  // loopback knows no multicast
  IPLocator::setIPv4(here, 127, 0, 0, 1);
  here.port = 0;
  qos.wire_protocol().builtin.initialPeersList.push_back(here);
  Locator_t own = here;
  qos.wire_protocol().builtin.metatrafficUnicastLocatorList.push_back(own);
  return DomainParticipantFactory::get_instance()->create_participant(domain, qos);
}

// As ROS 2 publishes: reliable; of latched topics who comes late is sent the last.
template <class Qos>
Qos as_ros(Qos qos, bool latched) {
  qos.reliability().kind = RELIABLE_RELIABILITY_QOS;
  qos.durability().kind = latched ? TRANSIENT_LOCAL_DURABILITY_QOS : VOLATILE_DURABILITY_QOS;
  qos.history().kind = KEEP_LAST_HISTORY_QOS;
  qos.history().depth = latched ? 1 : 100;
  return qos;
}

Topic* topic_of(DomainParticipant* participant, const char* name, TypeSupport type) {
  type.register_type(participant);
  return participant->create_topic(name, type.get_type_name(), TOPIC_QOS_DEFAULT);
}

int publish(int domain) {
  auto* participant = participant_of(domain);
  auto* publisher = participant->create_publisher(PUBLISHER_QOS_DEFAULT);
  auto* maps = publisher->create_datawriter(topic_of(participant, "rt/map", TypeSupport(new MapType())),
                                            as_ros(DATAWRITER_QOS_DEFAULT, true));
  auto* transforms = publisher->create_datawriter(
      topic_of(participant, "rt/tf", TypeSupport(new TransformsType())), as_ros(DATAWRITER_QOS_DEFAULT, false));
  auto map = drawn_map();
  auto message = drawn_transforms();
  maps->write(&map);
  std::thread([&] {
    while (true) {
      transforms->write(&message);
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
  }).detach();
  std::cout << "publishing" << std::endl;
  std::cin.get();
  std::quick_exit(0);
}

template <class Message>
Message first(DataReader* reader) {
  Message message;
  SampleInfo info;
  while (true) {
    reader->wait_for_unread_message({1, 0});
    if (reader->take_next_sample(&message, &info) == ReturnCode_t::RETCODE_OK && info.valid_data) return message;
  }
}

int listen(int domain) {
  auto* participant = participant_of(domain);
  auto* subscriber = participant->create_subscriber(SUBSCRIBER_QOS_DEFAULT);
  auto* maps = subscriber->create_datareader(
      topic_of(participant, "rt/mapmeld/map", TypeSupport(new MapType())), as_ros(DATAREADER_QOS_DEFAULT, true));
  auto* transforms = subscriber->create_datareader(
      topic_of(participant, "rt/tf_static", TypeSupport(new TransformsType())),
      as_ros(DATAREADER_QOS_DEFAULT, true));
  std::cout << "listening" << std::endl;
  const auto map = first<nav_msgs::msg::dds_::OccupancyGrid_>(maps);
  unsigned long sum = 0;
  for (uint8_t cell : map.data()) sum = (31 * sum + cell) % 1000000007;
  std::cout << map.header().frame_id() << " " << map.info().width() << " " << map.info().height() << " "
            << map.info().resolution() << " " << map.info().origin().position().x() << " " << sum << std::endl;
  const auto message = first<tf2_msgs::msg::dds_::TFMessage_>(transforms);
  for (const auto& each : message.transforms())
    std::cout << each.header().frame_id() << " " << each.child_frame_id() << " "
              << each.transform().translation().x() << std::endl;
  std::quick_exit(0);
}

template <class Type, class Message>
void record(const std::string& path, Message message) {
  Type type;
  SerializedPayload_t payload(type.getSerializedSizeProvider(&message)());
  type.serialize(&message, &payload);
  std::ofstream(path, std::ios::binary).write(reinterpret_cast<char*>(payload.data), payload.length);
}

int main(int count, char** words) {
  const std::string what = count == 3 ? words[1] : "";
  if (what == "publish") return publish(std::stoi(words[2]));
  if (what == "listen") return listen(std::stoi(words[2]));
  if (what != "record") return 2;
  record<MapType>(std::string(words[2]) + "/map.cdr", drawn_map());
  record<TransformsType>(std::string(words[2]) + "/tf.cdr", drawn_transforms());
}
