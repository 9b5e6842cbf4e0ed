"""Actor-critics: every part of them has a say, whatever they begin with, and in those that ship."""

import pytest
import torch
from torch import Tensor

from remqa_data.agents.networks.actor_critic import MOVES, ActorCritic, Form, KnowledgeGraph, Seen
from remqa_data.agents.networks.detection.pyramid import CHANNELS
from remqa_data.agents.networks.view_encoder import PARTS
from remqa_data.agents.training.weights import halved, load_network, weights_path

TYPES, STEPS, WALKS = 117, 6, 8
FORMS: tuple[Form, ...] = ("a3c", "scene_priors", "savn")


def without_gradient(model: ActorCritic) -> list[str]:
    """Names of what is learnt and yet changes nothing of what is thought and of the learnt loss, in some random views."""
    torch.manual_seed(0)
    asked = torch.randint(1, model.types + 1, (WALKS, 2))
    before = torch.rand(STEPS, WALKS, len(MOVES) + 1)
    thought = model(Seen(torch.rand(STEPS, WALKS, PARTS**2, CHANNELS) * 2, asked, before), model.rest(WALKS))
    told = thought.moves.square().sum() + thought.values.square().sum()
    if model.form == "savn":
        told = told + model.loss(thought.hidden[:, 0], thought.moves[:, 0].softmax(1))
    told.backward()
    return [
        name
        for name, parameter in model.named_parameters()
        if parameter.requires_grad and not (parameter.grad is not None and parameter.grad.abs().sum() > 0)
    ]


def some_relations(types: int) -> Tensor:
    """Each type lies near some five others."""
    return torch.bernoulli(torch.full((types, types), 5 / types), generator=torch.Generator().manual_seed(0))


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("seed", range(10))
def test_all_that_is_learnt_has_a_say_from_the_first_step_on(form: Form, seed: int) -> None:
    torch.manual_seed(seed)
    model = ActorCritic(TYPES, form)
    if form == "scene_priors":
        model.graph.learn_relations(some_relations(TYPES))
    assert without_gradient(model) == []


@pytest.mark.parametrize("form", FORMS)
def test_in_the_networks_that_ship_all_that_was_learnt_has_a_say(form: Form) -> None:
    model = load_network(weights_path(form))[0]
    assert isinstance(model, ActorCritic)
    assert without_gradient(model.float()) == []


@pytest.mark.parametrize("form", ["a3c", "scene_priors"])
def test_nothing_that_ships_is_as_it_began(form: Form) -> None:
    model, about = load_network(weights_path(form))
    torch.manual_seed(about.network.schedule.seed)
    began = ActorCritic(len(about.types), form)
    halved(began)
    learnt = {name: parameter for name, parameter in model.named_parameters() if parameter.requires_grad}
    assert len(learnt) > 5
    assert [name for name, parameter in learnt.items() if torch.equal(parameter, began.get_parameter(name))] == []


def test_the_graph_tells_of_what_lies_near_what_is_seen_and_of_nothing_else() -> None:
    """Types 0 and 1 lie near each other, 2 and 3 too; three convolutions never lead from one pair to the other."""
    counts = torch.zeros(4, 4)
    counts[0, 1] = counts[2, 3] = 2
    torch.manual_seed(0)
    graph = KnowledgeGraph(4)
    graph.learn_relations(counts)
    assert torch.allclose(graph.near, torch.block_diag(torch.full((2, 2), 0.5), torch.full((2, 2), 0.5)))
    nothing, first = torch.zeros(1, 4), torch.tensor([[1.0, 0.0, 0.0, 0.0]])
    asked = torch.tensor([4])
    change = (graph(first, asked) - graph(nothing, asked))[0]
    assert (change[:2].abs() > 1e-4).all()
    assert change[2:].tolist() == [0.0, 0.0]
