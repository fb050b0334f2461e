#include "param_values.hpp"

namespace robot_vision
{

ParamValues paramValues(const dynamic_reconfigure::Config& config)
{
  ParamValues values;
  for (const auto& param : config.bools)
    values[param.name] = static_cast<bool>(param.value);
  for (const auto& param : config.ints)
    values[param.name] = static_cast<int>(param.value);
  for (const auto& param : config.doubles)
    values[param.name] = param.value;
  for (const auto& param : config.strs)
    values[param.name] = param.value;
  return values;
}

}  // namespace robot_vision
