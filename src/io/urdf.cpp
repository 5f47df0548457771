// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/io/urdf.hpp"

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "trunnion/io/fault.hpp"
#include "trunnion/io/whole_file.hpp"

namespace trunnion::io {
namespace {

constexpr std::size_t kLargestUrdf = std::size_t{1} << 24U;
constexpr int kMostElements = 10000;

/// Takes what urdfdom would print.
class Capture : public console_bridge::OutputHandler {
 public:
  Capture() { console_bridge::useOutputHandler(this); }
  Capture(const Capture&) = delete;
  Capture& operator=(const Capture&) = delete;
  ~Capture() override { console_bridge::restorePreviousOutputHandler(); }
  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR && text_.empty()) text_ = text;
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
};

Vec3<double> vector(const urdf::Vector3& v) { return {v.x, v.y, v.z}; }

Mat3<double> rotation(const urdf::Rotation& q) {
  return Quaternion<double>(q.w, q.x, q.y, q.z).normalized().toRotationMatrix();
}

/// urdfdom's XML parser recurses: a file nested deeper than any rig would run out of stack. No deeper than it has
/// elements: what closes one is not looked for, as it may stand in a comment.
bool too_deep(const std::string& text) {
  int elements = 0;
  for (std::size_t i = 0; i + 1 < text.size(); ++i) elements += text[i] == '<' && text[i + 1] != '/' ? 1 : 0;
  return elements > kMostElements;
}

std::size_t count(const std::string& text, const std::string& word) {
  std::size_t n = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    const char after = at + word.size() < text.size() ? text[at + word.size()] : ' ';
    n += after == ' ' || after == '>' || after == '\n' || after == '\t' || after == '\r' ? 1 : 0;
  }
  return n;
}

/// Axis of a turning joint, checked.
Vec3<double> axis_of(const std::string& path, const urdf::Joint& joint) {
  const std::string field = "joint '" + joint.name + "'";
  if (joint.type != urdf::Joint::REVOLUTE && joint.type != urdf::Joint::CONTINUOUS) {
    throw input_error(path, 0, field, "should be revolute or continuous");
  }
  const Vec3<double> axis = vector(joint.axis);
  if (!axis.allFinite() || axis.norm() < 1e-9) throw input_error(path, 0, field, "has a zero axis");
  if (joint.limits && joint.type == urdf::Joint::REVOLUTE) {
    if (!std::isfinite(joint.limits->lower) || !std::isfinite(joint.limits->upper))
      throw input_error(path, 0, field, "limits are not finite");
    if (joint.limits->lower > joint.limits->upper) throw input_error(path, 0, field, "lower limit above the upper one");
    if (joint.limits->lower == joint.limits->upper)
      throw input_error(path, 0, field, "limits leave it no room to turn");
  }
  return axis.normalized();
}

/// A velocity of zero is none: URDF wants the attribute where nobody knows it.
AxisLimits limits_of(const urdf::Joint& joint) {
  AxisLimits limits;
  if (!joint.limits) return limits;
  if (joint.type == urdf::Joint::REVOLUTE) {
    limits.lowest = joint.limits->lower;
    limits.highest = joint.limits->upper;
  }
  if (joint.limits->velocity > 0.0) limits.rate = joint.limits->velocity;
  return limits;
}

}  // namespace

RigFile read_rig(const std::string& path, const std::string& outer_axis, const std::string& inner_axis,
                 const std::vector<std::string>& wanted) {
  const std::string text = read_whole(path, kLargestUrdf);
  if (!is_utf_8(text))  // TinyXML reads on past the end after a character that has not the bytes it promises
    throw input_error(path, 0, "", "is no text in UTF-8");
  if (too_deep(text)) throw input_error(path, 0, "", "has more than " + std::to_string(kMostElements) + " elements");
  Capture capture;
  const urdf::ModelInterfaceSharedPtr model = urdf::parseURDF(text);
  if (!model)
    throw input_error(path, 0, "",
                      "not a usable URDF" + (capture.text().empty() ? std::string() : ": " + capture.text()));
  if (count(text, "<robot") > 1) throw input_error(path, 0, "robot", "stands more than once");

  std::set<std::string> children;
  for (const auto& [name, joint] : model->joints_) {
    if (!children.insert(joint->child_link_name).second) {
      throw input_error(path, 0, "link '" + joint->child_link_name + "'",
                        "has two parent joints: the rig should be a tree");
    }
    const urdf::Pose& origin = joint->parent_to_joint_origin_transform;
    if (!vector(origin.position).allFinite() ||
        !std::isfinite(origin.rotation.w + origin.rotation.x + origin.rotation.y + origin.rotation.z)) {
      throw input_error(path, 0, "joint '" + name + "'", "origin is not finite");
    }
  }
  const auto joint_named = [&](const std::string& name) {
    const auto found = model->joints_.find(name);
    if (found == model->joints_.end())
      throw input_error(path, 0, "joint '" + name + "'", "is missing: the rig needs an outer and an inner axis");
    return found->second;
  };
  const auto outer = joint_named(outer_axis);
  const auto inner = joint_named(inner_axis);

  /// Product of the fixed joints from @p link up to @p ancestor. @return false when a moving joint or the root
  /// intervenes
  const auto fixed_chain = [&](std::string link, const std::string& ancestor, Mat3<double>& C, Vec3<double>& r) {
    C.setIdentity();
    r.setZero();
    for (std::size_t steps = 0; link != ancestor; ++steps) {
      const auto at = model->links_.find(link);
      if (at == model->links_.end() || !at->second->parent_joint || steps > model->joints_.size()) return false;
      const urdf::Joint& joint = *at->second->parent_joint;
      if (joint.type != urdf::Joint::FIXED) return false;
      const Mat3<double> step = rotation(joint.parent_to_joint_origin_transform.rotation);
      r = vector(joint.parent_to_joint_origin_transform.position) + step * r;
      C = step * C;
      link = joint.parent_link_name;
    }
    return true;
  };
  const auto through = [&](const urdf::Joint& joint, const std::string& from, Mat3<double>& C, Vec3<double>& r) {
    if (!fixed_chain(joint.parent_link_name, from, C, r)) {
      throw input_error(path, 0, "joint '" + joint.name + "'",
                        "does not hang from link '" + from + "' by fixed joints only");
    }
    r += C * vector(joint.parent_to_joint_origin_transform.position);
    C *= rotation(joint.parent_to_joint_origin_transform.rotation);
  };

  Mat3<double> C_ta;
  Mat3<double> C_ap;
  Vec3<double> azimuth_joint_t;
  Vec3<double> pitch_joint_a;
  const Vec3<double> outer_direction = axis_of(path, *outer);
  const Vec3<double> inner_direction = axis_of(path, *inner);
  through(*outer, model->getRoot()->name, C_ta, azimuth_joint_t);
  through(*inner, outer->child_link_name, C_ap, pitch_joint_a);
  const Result<TwoAxisGeometry> geometry =
      TwoAxisGeometry::from_chain(C_ta, outer_direction, C_ap, pitch_joint_a, inner_direction);
  if (!geometry.ok())
    throw input_error(path, 0, "joint '" + inner_axis + "'",
                      "is parallel to '" + outer_axis + "': the rig has no two axes");

  RigFile file;
  file.rig.geometry = geometry.value();
  file.limits = {limits_of(*outer), limits_of(*inner)};
  std::vector<std::string> found;
  for (const auto& [name, joint] : model->joints_) {
    const auto child = model->links_.find(joint->child_link_name);
    const bool leaf = child != model->links_.end() && child->second->child_joints.empty();
    Mat3<double> C;
    Vec3<double> r;
    if (joint->type == urdf::Joint::FIXED && leaf && fixed_chain(joint->child_link_name, inner->child_link_name, C, r))
      found.push_back(name);
  }
  std::sort(found.begin(), found.end());
  file.mounts = wanted.empty() ? found : wanted;
  if (file.mounts.empty())
    throw input_error(path, 0, "", "has no mount: a fixed joint from the pitch stage to the unit's case");
  if (file.mounts.size() > kMaxMounts)
    throw input_error(path, 0, "", "has more than " + std::to_string(kMaxMounts) + " mounts");
  for (std::size_t m = 0; m < file.mounts.size(); ++m) {
    const std::string& name = file.mounts[m];
    if (std::find(found.begin(), found.end(), name) == found.end()) {
      std::string known;
      for (const std::string& one : found) known += (known.empty() ? "" : ", ") + one;
      throw input_error(path, 0, "mount '" + name + "'",
                        "is no fixed joint of the pitch stage that ends in the unit's case; the rig has: " + known);
    }
    fixed_chain(model->joints_.at(name)->child_link_name, inner->child_link_name, file.rig.mount[m].C_pb,
                file.rig.mount[m].lever_p);
  }
  file.rig.mounts = static_cast<int>(file.mounts.size());
  return file;
}

}  // namespace trunnion::io
