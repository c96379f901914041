#include "codegen/urdf/urdf_document.h"

#include <tinyxml2.h>

#include <charconv>
#include <cmath>
#include <fstream>
#include <set>
#include <sstream>
#include <system_error>

#include "codegen/urdf/urdf_error.h"

namespace stilt::codegen {
namespace {

using tinyxml2::XMLElement;

/// Checks and collects the content of one document.
class DocumentReader {
 public:
  DocumentReader(const std::string& source, const XMLElement& robot) : source_(source), robot_(robot) {}

  void check_tree() {
    for (const XMLElement* link = first("link"); link != nullptr; link = next(link, "link")) {
      const std::string name = attribute(*link, "name", "a link");
      if (!links_.insert(name).second) fail("link '" + name + "' is defined twice; names must be unique");
    }
    if (links_.empty()) fail("there is no link; a robot needs at least a base and a foot");
    for (const XMLElement* joint = first("joint"); joint != nullptr; joint = next(joint, "joint"))
      check_joint(*joint);
    check_connected();
  }

  [[nodiscard]] const std::vector<std::string>& joint_names() const { return joint_names_; }

  /// Those below <robot>, as ROS 1 writes them, and those below every <ros2_control>.
  [[nodiscard]] std::map<std::string, Transmission> transmissions() const {
    std::map<std::string, Transmission> result;
    add_transmissions(robot_, result);
    for (const XMLElement* c = first("ros2_control"); c != nullptr; c = next(c, "ros2_control"))
      add_transmissions(*c, result);
    return result;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw UrdfError(source_ + ": " + what + "."); }

  [[nodiscard]] const XMLElement* first(const char* kind) const { return robot_.FirstChildElement(kind); }
  static const XMLElement* next(const XMLElement* element, const char* kind) {
    return element->NextSiblingElement(kind);
  }

  [[nodiscard]] std::string attribute(const XMLElement& element, const char* name,
                                      const std::string& owner) const {
    const char* value = element.Attribute(name);
    if (value == nullptr)
      fail(owner + " in line " + std::to_string(element.GetLineNum()) + " has no '" + name + "'");
    return value;
  }

  [[nodiscard]] std::string end(const XMLElement& joint, const char* kind, const std::string& name) const {
    const XMLElement* element = joint.FirstChildElement(kind);
    if (element == nullptr) fail("joint '" + name + "' has no <" + kind + ">");
    std::string link = attribute(*element, "link", std::string("the <") + kind + "> of joint '" + name + "'");
    if (!links_.contains(link)) fail("joint '" + name + "' names link '" + link + "', which does not exist");
    return link;
  }

  void check_joint(const XMLElement& joint) {
    const std::string name = attribute(joint, "name", "a joint");
    for (const std::string& other : joint_names_) {
      if (other == name) fail("joint '" + name + "' is defined twice; names must be unique");
    }
    if (joint.FirstChildElement("mimic") != nullptr) {
      fail("joint '" + name +
           "' has <mimic>, which is not supported; each joint must have a motor of its own");
    }
    joint_names_.push_back(name);
    const std::string parent = end(joint, "parent", name);
    const std::string child = end(joint, "child", name);
    const auto [entry, inserted] = carrier_.try_emplace(child, name, parent);
    if (!inserted) {
      fail("not a tree: link '" + child + "' is the child of joints '" + entry->second.first + "' and '" +
           name + "'; every link may have one parent");
    }
  }

  /// Checks that there is one root, at which the chain of parents of every link ends.
  void check_connected() const {
    std::vector<std::string> roots;
    for (const std::string& link : links_) {
      if (!carrier_.contains(link)) roots.push_back(link);
    }
    if (roots.size() > 1) {
      fail("not a tree: links '" + roots[0] + "' and '" + roots[1] +
           "' both have no parent; only the base may");
    }
    for (const std::string& link : links_) {
      std::set<std::string> seen;
      for (std::string i = link; carrier_.contains(i); i = carrier_.at(i).second) {
        if (!seen.insert(i).second) fail("not a tree: the joints above link '" + link + "' form a loop");
      }
    }
  }

  void add_transmissions(const XMLElement& parent, std::map<std::string, Transmission>& result) const {
    for (const XMLElement* t = parent.FirstChildElement("transmission"); t != nullptr;
         t = next(t, "transmission")) {
      const XMLElement* joint = t->FirstChildElement("joint");
      if (joint == nullptr) fail("a transmission has no joint; it needs <joint name=\"...\"/>");
      const std::string name = attribute(*joint, "name", "a transmission's joint");
      bool known = false;
      for (const std::string& other : joint_names_) known = known || other == name;
      if (!known) fail("a transmission names joint '" + name + "', which does not exist");
      const XMLElement* actuator = t->FirstChildElement("actuator");
      if (actuator == nullptr) fail("the transmission of joint '" + name + "' has no <actuator>");
      for (const XMLElement* part : {joint, actuator}) {
        if (next(part, part->Name()) == nullptr) continue;
        fail("the transmission of joint '" + name + "' has two <" + part->Name() +
             ">; a joint has one motor, and a motor one joint");
      }
      if (!result.try_emplace(name, drive(*joint, *actuator, name)).second)
        fail("joint '" + name + "' has two transmissions; it may have one");
    }
  }

  [[nodiscard]] double gear_ratio(const XMLElement& e, const std::string& name) const {
    const double ratio = number(e, name);
    const std::string element = std::string("<").append(e.Name()).append(">");
    if (!(ratio > 0.0)) fail(element + " of joint '" + name + "' must be above zero");
    return ratio;
  }

  /// The numbers of a transmission. The gear ratio has two spellings, that of ROS 1 and that of ros2_control,
  /// and two places: ros2_control writes it into <joint>.
  [[nodiscard]] Transmission drive(const XMLElement& joint, const XMLElement& actuator,
                                   const std::string& name) const {
    Transmission result;
    bool geared = false;
    for (const XMLElement* owner : {&joint, &actuator}) {
      for (const XMLElement* e = owner->FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
        const std::string kind = e->Name();
        if (kind == "mechanicalReduction" || kind == "mechanical_reduction") {
          if (geared) fail("the transmission of joint '" + name + "' has two gear ratios; it may have one");
          result.gear_ratio = gear_ratio(*e, name);
          geared = true;
        } else if (kind == "rotorInertia" && owner == &actuator) {
          result.rotor_inertia_kg_m2 = number(*e, name);
        } else if (!is_without_inertia(kind, owner == &actuator)) {
          fail_unknown(owner->Name(), name, kind);
        }
      }
    }
    if (!geared) {
      fail("the <actuator> of joint '" + name +
           "' has no <mechanicalReduction>; it needs the gear ratio, 1 without a gear");
    }
    return result;
  }

  /// Whether an element of a transmission changes no inertia: the kind of command, and of a joint the offset.
  static bool is_without_inertia(const std::string& kind, bool in_actuator) {
    return kind == "hardwareInterface" || (kind == "offset" && !in_actuator);
  }

  [[noreturn]] void fail_unknown(const std::string& owner, const std::string& joint,
                                 const std::string& kind) const {
    const std::string what = owner == "actuator" ? "the <actuator> of joint '" + joint + "'"
                                                 : "the <joint> of the transmission of joint '" + joint + "'";
    const std::string other = owner == "actuator" ? "<rotorInertia>" : "<offset>";
    fail(what + " has <" + kind + ">; it may have <mechanicalReduction>, " + other +
         " and <hardwareInterface>");
  }

  /// The whole text of an element, without the space around it, is a number; 0,5 and 5 kg are none.
  [[nodiscard]] double number(const XMLElement& element, const std::string& joint) const {
    constexpr const char* kSpace = " \t\r\n";
    std::string text = element.GetText() == nullptr ? "" : element.GetText();
    text.erase(0, text.find_first_not_of(kSpace));
    text.erase(text.find_last_not_of(kSpace) + 1);
    const char* end = text.data() + text.size();
    const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
    double value = 0.0;
    const auto [stop, error] = std::from_chars(begin, end, value);
    if (error != std::errc{} || stop != end || !std::isfinite(value) || value < 0.0) {
      fail(std::string("<") + element.Name() + "> of joint '" + joint + "' is '" + text +
           "'; it must be a number that is not negative");
    }
    return value;
  }

  const std::string& source_;
  const XMLElement& robot_;
  std::set<std::string> links_;
  std::vector<std::string> joint_names_;
  std::map<std::string, std::pair<std::string, std::string>> carrier_;  ///< link -> joint and parent link
};

}  // namespace

std::string read_text(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();  // fails on a folder, where an iterator throws
  if (!text) throw UrdfError(file + ": cannot be read; give the path of a URDF file.");
  return text.str();
}

UrdfDocument parse_urdf_document(const std::string& text, const std::string& source) {
  tinyxml2::XMLDocument xml;
  if (xml.Parse(text.c_str()) != tinyxml2::XML_SUCCESS) {
    throw UrdfError(source + ": not valid XML in line " + std::to_string(xml.ErrorLineNum()) +
                    "; a URDF is an XML file with the root element <robot>.");
  }
  const XMLElement* robot = xml.RootElement();
  if (robot == nullptr || std::string(robot->Name()) != "robot") {
    throw UrdfError(source + ": the root element is not <robot>; give a URDF file.");
  }
  DocumentReader reader(source, *robot);
  reader.check_tree();
  return {.joint_names = reader.joint_names(), .transmissions = reader.transmissions()};
}

}  // namespace stilt::codegen
