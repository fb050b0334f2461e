#pragma once

#include <dynamic_reconfigure/server.h>
#include <ros/ros.h>
#include <std_srvs/Trigger.h>

#include <functional>
#include <stdexcept>
#include <string>
#include <system_error>

#include "package_file.hpp"
#include "params.hpp"
#include "robot_vision/common/printable.hpp"
#include "save_params.hpp"
#include "whole_config.hpp"

namespace robot_vision
{

/// A node's live parameters: read and checked at start, changed through dynamic_reconfigure, saved by ~save_parameters
/// in the file that ~config_file names. `Config` is generated from a .cfg file.
template <class Config>
class LiveParams
{
public:
  /// Applies the values, or throws std::invalid_argument to refuse them.
  using Apply = std::function<void(const Config&)>;
  /// Gives maps of further parameters to save with these.
  using Maps = std::function<ParamMaps()>;

  /// Reads and applies the parameters of `pnh`; throws std::invalid_argument naming the first invalid one.
  LiveParams(const ros::NodeHandle& pnh, const Apply& apply, const Maps& maps = nullptr)
    : pnh_(pnh), apply_(apply), maps_(maps), config_(present(pnh))
  {
    apply_(config_);
    server_ = std::make_unique<dynamic_reconfigure::Server<Unclamped>>(mutex_, pnh_);
    server_->setCallback([this](Unclamped& config, std::uint32_t) { change(config); });
    save_ = pnh_.advertiseService("save_parameters", &LiveParams::save, this);
  }

private:
  /// A Config that the server does not silently clamp to its ranges, because the node refuses such values.
  struct Unclamped : WholeConfig<Config, readParams>
  {
    using WholeConfig<Config, readParams>::WholeConfig;
    void __clamp__() {}
  };

  static Config present(const ros::NodeHandle& pnh)
  {
    Unclamped config;
    config.__fromServer__(pnh);
    return config;
  }

  void change(Unclamped& config)
  {
    try
    {
      apply_(config);
      config_ = config;
    }
    catch (const std::exception& e)
    {
      ROS_WARN("%s: refused, the parameters stay as they are: %s", pnh_.getNamespace().c_str(),
               logLine(e.what()).c_str());
      static_cast<Config&>(config) = config_;
    }
  }

  bool save(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response)
  {
    std::string path;
    dynamic_reconfigure::Config message;
    try
    {
      const boost::recursive_mutex::scoped_lock lock(mutex_);
      config_.__toMessage__(message);
      readParam(pnh_, "config_file", path);
      if (path.empty()) throw std::runtime_error("~config_file does not name a file");
      // roslaunch has read a relative path in its own folder, but its nodes run in another one.
      if (path.front() != '/')
        throw std::runtime_error("~config_file is '" + logLine(path) + "', must be an absolute path");
      requireOwnLaunch(path);
      saveParams(path, message, maps_ ? maps_() : ParamMaps());
      response.success = true;
      response.message = path;
    }
    catch (const std::system_error& e)  // such as for the file of an installed package
    {
      refuse(response, std::string(e.what()) +
                           "; ~config_file names the file, as config:=/absolute/path.yaml of the launch files does");
    }
    catch (const std::exception& e)
    {
      refuse(response, e.what());
    }
    return true;
  }

  void refuse(std_srvs::Trigger::Response& response, const std::string& reason) const
  {
    response.success = false;
    response.message = logLine(reason);
    ROS_ERROR("%s: parameters not saved: %s", pnh_.getNamespace().c_str(), response.message.c_str());
  }

  ros::NodeHandle pnh_;
  Apply apply_;
  Maps maps_;
  boost::recursive_mutex mutex_;  // guards config_, which two services use
  Config config_;
  std::unique_ptr<dynamic_reconfigure::Server<Unclamped>> server_;
  ros::ServiceServer save_;
};

}  // namespace robot_vision
