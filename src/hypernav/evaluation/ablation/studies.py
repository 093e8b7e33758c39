"""The studies that run variants, by name."""

from collections.abc import Callable

from hypernav.evaluation.ablation.model_quality import model_quality
from hypernav.evaluation.ablation.study import Method, Study
from hypernav.evaluation.ablation.study_name import StudyName
from hypernav.evaluation.ablation.switches import switches

STUDIES: dict[StudyName, Callable[[Method], Study]] = {
    "switches": switches,
    "model": model_quality,
}
