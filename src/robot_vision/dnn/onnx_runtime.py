"""Networks run by onnxruntime (https://onnxruntime.ai)."""

import os
from typing import Sequence

import numpy as np

from .model_facts import ModelFile
from .network_input import NetworkInput
from .onnxruntime_folder import find_onnxruntime
from .runtime import Runtime, on_processors, reason_of

HINT = "onnxruntime is usually two to four times as fast: `make onnxruntime` installs it"
OPTIMIZATIONS = {"all": "ORT_ENABLE_ALL", "basic": "ORT_ENABLE_BASIC", "none": "ORT_DISABLE_ALL"}


class OnnxRuntime(Runtime):
    """onnxruntime on processors. Its threads wait without turning in a loop.

    Raises:
        ValueError: It is not there, or cannot read the model.
    """

    name = "onnxruntime"

    def __init__(
        self,
        model: ModelFile,
        network_input: NetworkInput,
        threads: int = 1,
        affinity: Sequence[int] = (),
        optimization: str = "all",
    ):
        super().__init__(network_input, affinity)
        module, reason = find_onnxruntime()
        if module is None:
            raise ValueError(f"{reason}; {HINT}")
        options = module.SessionOptions()
        # Told 0, it would keep one on each core, also on those where this process must not run.
        processors = self._affinity or os.sched_getaffinity(0)
        options.intra_op_num_threads = threads or len(processors)
        options.inter_op_num_threads = 1
        options.log_severity_level = 4  # what it throws says the same
        level = getattr(module.GraphOptimizationLevel, OPTIMIZATIONS[optimization])
        options.graph_optimization_level = level
        # Between two frames they would take the time of other nodes.
        options.add_session_config_entry("session.intra_op.allow_spinning", "0")
        try:
            with on_processors(self._affinity):  # which the session's threads inherit
                self._session = module.InferenceSession(
                    model.data, options, providers=["CPUExecutionProvider"]
                )
            self._name = self._session.get_inputs()[0].name
            self.output_names = [one.name for one in self._session.get_outputs()]
        except Exception as error:
            raise ValueError(f"onnxruntime cannot read it: {reason_of(error)}") from None

    def _forward(self, values: np.ndarray) -> Sequence[np.ndarray]:
        return self._session.run(None, {self._name: values})
