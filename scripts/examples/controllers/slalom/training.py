"""PPO (skrl, on JAX) in the slalom environment."""

import dataclasses
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import flax.linen as nn
import gymnasium
import jax
import jax.numpy as jnp
import numpy as np
from gymnasium.vector import AutoresetMode, SyncVectorEnv
from skrl.agents.jax.ppo import PPO, PPO_CFG
from skrl.envs.wrappers.jax import wrap_env
from skrl.memories.jax import RandomMemory
from skrl.models.jax import DeterministicMixin, GaussianMixin, Model
from skrl.trainers.jax import SequentialTrainer, SequentialTrainerCfg
from skrl.utils import set_seed

from .drivers import Driver

ENVIRONMENTS, ROLLOUT = 64, 32  # environments side by side; steps of each between two updates
FIRST_LOG_STD = -0.7  # of the actions, by which exploration begins
HIDDEN = (64, 64)
REWARD_SCALE = 0.1  # so that the values to be learned are near 1


class Episodes(gymnasium.Wrapper):
    """Notes every episode's end: steps that all environments have made until then, reward, and gates passed."""

    def __init__(self, environment: gymnasium.Env, ended: list[tuple[int, float, int]]) -> None:
        super().__init__(environment)
        self._ended, self._reward, self._steps = ended, 0.0, 0

    def step(self, action: np.ndarray) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        result = self.env.step(action)
        _, reward, terminated, truncated, info = result
        self._reward += float(reward)
        self._steps += ENVIRONMENTS
        if terminated or truncated:
            self._ended.append((self._steps, self._reward, info["gates_passed"]))
            self._reward = 0.0
        return result


def network(inputs: dict[str, jax.Array], outputs: int) -> jax.Array:
    """Two hidden layers."""
    x = inputs["observations"]
    for width in HIDDEN:
        x = nn.tanh(nn.Dense(width, kernel_init=nn.initializers.orthogonal(np.sqrt(2)))(x))
    return nn.Dense(outputs, kernel_init=nn.initializers.orthogonal(0.01))(x)


class Policy(GaussianMixin, Model):
    """Mean of the actions by the observation; their spread is learned beside it."""

    def __init__(self, observation_space: gymnasium.Space, action_space: gymnasium.Space, device: Any = None, **kwargs: Any) -> None:
        Model.__init__(self, observation_space=observation_space, action_space=action_space, device=device, **kwargs)
        GaussianMixin.__init__(self)

    @nn.compact
    def __call__(self, inputs: dict[str, jax.Array], role: str) -> tuple[jax.Array, dict[str, jax.Array]]:
        log_std = self.param("log_std", lambda _: FIRST_LOG_STD * jnp.ones(self.num_actions))
        return network(inputs, self.num_actions), {"log_std": log_std}


class Value(DeterministicMixin, Model):
    """Expected reward from an observation on."""

    def __init__(self, observation_space: gymnasium.Space, action_space: gymnasium.Space, device: Any = None, **kwargs: Any) -> None:
        Model.__init__(self, observation_space=observation_space, action_space=action_space, device=device, **kwargs)
        DeterministicMixin.__init__(self)

    @nn.compact
    def __call__(self, inputs: dict[str, jax.Array], role: str) -> tuple[jax.Array, dict[str, jax.Array]]:
        return network(inputs, 1), {}


@dataclasses.dataclass
class Trained:
    """What training gives: the driver before and after it, and each episode on the way (as `Episodes` notes them)."""

    before: Driver
    after: Driver
    episodes: np.ndarray
    parameters: dict[str, np.ndarray]


def driver(policy: Policy) -> Driver:
    """The policy's mean action, with the parameters that it has now."""
    parameters = jax.tree.map(np.array, policy.state_dict.params)
    apply = jax.jit(lambda observation: policy.apply(parameters, {"observations": observation}, "policy")[0])
    return lambda observation: np.asarray(apply(observation[None]))[0]


def train(make: Callable[[], gymnasium.Env], steps: int, seed: int) -> Trained:
    """Trains for that many steps of all environments together."""
    set_seed(seed)
    ended: list[tuple[int, float, int]] = []
    vector = SyncVectorEnv([lambda: Episodes(make(), ended)] * ENVIRONMENTS, autoreset_mode=AutoresetMode.SAME_STEP)
    environment = wrap_env(vector, wrapper="gymnasium", verbose=False)
    spaces = {"observation_space": environment.observation_space, "action_space": environment.action_space}
    models = {"policy": Policy(**spaces), "value": Value(**spaces)}
    for role, model in models.items():
        model.init_state_dict(role=role)
    before = driver(models["policy"])
    memory = RandomMemory(memory_size=ROLLOUT, num_envs=ENVIRONMENTS)
    with tempfile.TemporaryDirectory() as folder:
        settings = PPO_CFG(
            rollouts=ROLLOUT, learning_epochs=10, mini_batches=8, learning_rate=5e-4, discount_factor=0.98, gae_lambda=0.95,
            entropy_loss_scale=0.0, value_loss_scale=0.5, grad_norm_clip=0.5, time_limit_bootstrap=True,
            rewards_shaper=lambda reward, *_: REWARD_SCALE * reward,
            experiment={"directory": folder, "write_interval": 0, "checkpoint_interval": 0},
        )  # fmt: skip
        agent = PPO(models=models, memory=memory, cfg=settings, **spaces)
        SequentialTrainer(env=environment, agents=agent,
                          cfg=SequentialTrainerCfg(timesteps=steps // ENVIRONMENTS, headless=True)).train()
    vector.close()
    flat = jax.tree_util.tree_leaves_with_path(models["policy"].state_dict.params)
    parameters = {jax.tree_util.keystr(path, simple=True, separator="/"): np.array(leaf) for path, leaf in flat}
    return Trained(before, driver(models["policy"]), np.array(ended).reshape(-1, 3), parameters)
