"""Chat models in this process: Qwen2.5-VL, Qwen3-VL and others that the Auto classes load.

For closed questions no text is generated: every allowed answer is scored, so the probabilities are
exact and no other answer is possible.
"""

import json
import threading
import time
from typing import Any

from hypernav.core.chat import Answer, Question, Usage
from hypernav.core.components.registry import require
from hypernav.core.errors import ModelError, ModelUnavailableError
from hypernav.search.models.chat.answer_parsing import parse_answer
from hypernav.search.models.chat.config import ChatConfig
from hypernav.search.models.network_loading import (
    EXTRA,
    choose_device,
    choose_dtype,
    load_network,
    load_pretrained,
)


class LocalChat:
    """Asks a model in this process. Threads take turns: a GPU answers one question at a time."""

    def __init__(self, path: str, config: ChatConfig | None = None) -> None:
        """Load a model from disk.

        Args:
            path: A folder, or the id of a model in the local Hugging Face cache.
            config: Device, dtype and sampling.

        Raises:
            MissingExtraError: torch or transformers is not installed.
            ModelError: There are no such weights here, they cannot see images, or they do not fit
                into the device's memory.
        """
        self.config = config or ChatConfig()
        self._torch = require("torch", extra=EXTRA)
        self._pil = require("PIL.Image", extra=EXTRA)
        self._path = path
        self.device = choose_device(self.config.device)
        dtype = choose_dtype(self.device, self.config.dtype)
        self._processor = load_pretrained("AutoProcessor", path)
        if getattr(self._processor, "image_processor", None) is None:
            raise ModelError(f"'{path}' is a model for text only; it cannot see images")
        self._model = load_network("AutoModelForImageTextToText", path, self.device, dtype)
        self._lock = threading.Lock()

    def identify(self) -> str:
        """Path or id of the model."""
        return self._path

    def ask(self, question: Question) -> Answer:
        """Answer a question.

        Raises:
            ModelUnavailableError: The device ran out of memory.
        """
        begin = time.monotonic()
        probabilities: dict[str, float] = {}
        try:
            with self._lock, self._torch.inference_mode():
                inputs = self._inputs(question)
                if question.allowed:
                    probabilities = self._decide(inputs, question.allowed)
                    text, tokens_out = (
                        max(probabilities, key=lambda answer: probabilities[answer]),
                        1,
                    )
                else:
                    text, tokens_out = self._generate(inputs, question.max_tokens)
        except self._torch.OutOfMemoryError as error:
            raise ModelUnavailableError(
                f"{self._path}: {self.device} ran out of memory; use a smaller model or a server"
            ) from error
        return parse_answer(
            question,
            text,
            model=self._path,
            usage=Usage(int(inputs["input_ids"].shape[1]), tokens_out),
            seconds=time.monotonic() - begin,
            probabilities=probabilities,
            is_cut=tokens_out >= question.max_tokens,
        )

    def _inputs(self, question: Question) -> dict[str, Any]:
        """The prompt with its images, formatted by the model's own chat template."""
        text = question.text
        if question.form is not None:
            text += f"\n\nAnswer with JSON of this schema: {_schema(question)}"
        images = [
            {"type": "image", "image": self._pil.fromarray(image)} for image in question.images
        ]
        messages = [{"role": "user", "content": [*images, {"type": "text", "text": text}]}]
        inputs = self._processor.apply_chat_template(
            messages,
            add_generation_prompt=True,
            tokenize=True,
            return_dict=True,
            return_tensors="pt",
        )
        return dict(inputs.to(self.device))

    def _generate(self, inputs: dict[str, Any], max_tokens: int) -> tuple[str, int]:
        temperature = self.config.temperature or 0.0
        sampling = {"do_sample": False, "temperature": None, "top_p": None, "top_k": None}
        if temperature > 0.0:
            sampling = {"do_sample": True, "temperature": temperature}
        with self._torch.random.fork_rng(enabled=self.config.seed is not None):
            if self.config.seed is not None:
                self._torch.manual_seed(self.config.seed)
            output = self._model.generate(**inputs, max_new_tokens=max_tokens, **sampling)
        written = output[0, inputs["input_ids"].shape[1] :]
        text = self._processor.tokenizer.decode(written, skip_special_tokens=True)
        return text, int(written.shape[0])

    def _decide(self, inputs: dict[str, Any], allowed: tuple[str, ...]) -> dict[str, float]:
        """The probability of every allowed answer, given that it is one of them."""
        tokenizer = self._processor.tokenizer
        end = tokenizer.eos_token_id
        spelt = {
            answer: (*tokenizer(answer, add_special_tokens=False)["input_ids"], end)
            for answer in allowed
        }
        logs = dict.fromkeys(allowed, 0.0)
        prefixes = {tokens[:cut] for tokens in spelt.values() for cut in range(len(tokens))}
        for prefix in sorted(prefixes):
            following = {
                answer: tokens[len(prefix)]
                for answer, tokens in spelt.items()
                if tokens[: len(prefix)] == prefix
            }
            options = sorted(set(following.values()))
            if len(options) == 1:
                continue
            scores = self._next_scores(inputs, prefix)[options].log_softmax(0).tolist()
            by_token = dict(zip(options, scores, strict=True))
            for answer, token in following.items():
                logs[answer] += by_token[token]
        probabilities = self._torch.tensor(list(logs.values()), dtype=self._torch.float64).softmax(
            0
        )
        return dict(zip(allowed, probabilities.tolist(), strict=True))

    def _next_scores(self, inputs: dict[str, Any], prefix: tuple[int, ...]) -> Any:
        """The scores of all tokens after the prompt and the beginning of an answer."""
        shape = inputs["input_ids"].shape
        extended = dict(inputs)
        for key, value in inputs.items():
            if value.shape == shape and prefix:
                fill = {"input_ids": prefix, "attention_mask": (1,) * len(prefix)}
                tail = value.new_tensor([fill.get(key, (0,) * len(prefix))])
                extended[key] = self._torch.cat([value, tail], dim=1)
        logits = self._model(**extended, use_cache=False, logits_to_keep=1).logits
        return logits[0, -1].float()


def _schema(question: Question) -> str:
    schema = {} if question.form is None else question.form.model_json_schema()
    return json.dumps(schema, separators=(",", ":"))
