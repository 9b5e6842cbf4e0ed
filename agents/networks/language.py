"""Words as vectors."""

from __future__ import annotations

from typing import NamedTuple

import torch
from torch import Tensor, nn
from torch.nn.utils.rnn import pack_padded_sequence, pad_packed_sequence

EMBEDDED = 64
HIDDEN = 64
"""Numbers of a word's embedding, and of an LSTM in each direction."""


class Words(NamedTuple):
    """What was read.

    Attributes
    ----------
    embedded : (n, t, EMBEDDED)
        The words by themselves.
    read : (n, t, 2 HIDDEN)
        The words in their sentence.
    sentence : (n, 2 HIDDEN)
        The last state of each direction.
    is_word : (n, t) bool
        False at padding.
    """

    embedded: Tensor
    read: Tensor
    sentence: Tensor
    is_word: Tensor


class WordReader(nn.Module):
    """An embedding and a bidirectional LSTM.

    Parameters
    ----------
    words : int
        Size of the vocabulary; word 0 is padding.
    layers : int
        Of the LSTM.
    dropout : float
        Of the embedding.
    """

    def __init__(self, words: int, layers: int = 1, dropout: float = 0.2) -> None:
        super().__init__()
        self.embedding = nn.Embedding(words, EMBEDDED, padding_idx=0)
        self.dropout = nn.Dropout(dropout)
        self.lstm = nn.LSTM(EMBEDDED, HIDDEN, layers, batch_first=True, bidirectional=True)

    def forward(self, numbers: Tensor) -> Words:
        """Read (n, t) int64 numbers of words, 0 after the end of each sentence."""
        is_word = numbers > 0
        lengths = is_word.sum(1).clamp(min=1)
        embedded = self.dropout(self.embedding(numbers))
        packed = pack_padded_sequence(embedded, lengths.cpu(), batch_first=True, enforce_sorted=False)
        read, (last, _) = self.lstm(packed)
        read, _ = pad_packed_sequence(read, batch_first=True, total_length=numbers.shape[1])
        return Words(embedded, read, torch.cat([last[-2], last[-1]], 1), is_word)
